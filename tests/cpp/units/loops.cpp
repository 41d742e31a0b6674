// Loops that draw, as the enumerator walks them: enumerator.hpp, loop_chain.hpp and drawing_loop.hpp.
#include "aos/model/drawing_loop.hpp"

#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "check.hpp"

namespace units::loops_tests {

using aos::DirectedDraws;
using aos::DrawingLoop;
using aos::Enumerator;

// The probabilities of what code gives, and of what was left out.
struct Outcomes {
  std::map<int, double> odds;
  double left_out = 0;
  int runs = 0;
};

template <class Code>
Outcomes outcomes_of(Code&& code, aos::NumberSink* sink = nullptr, int max_paths = aos::path_budget) {
  Outcomes outcomes;
  Enumerator draws;
  draws.report_to(sink);
  int result = 0;
  outcomes.left_out = draws.for_nearly_each_path(
      [&](Enumerator& path) {
        ++outcomes.runs;
        result = code(static_cast<DirectedDraws&>(path));
      },
      [&](Enumerator& path) { outcomes.odds[result] += path.probability(); }, max_paths);
  return outcomes;
}

TEST("A draw that is made again until it fits gives one outcome, exactly") {
  const Outcomes found = outcomes_of([](DirectedDraws& AOS) {
    int side = 0;
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(side), std::tie()), side == 0) side = AOS.Bernoulli(0.5) ? 0 : 1;
    return side;
  });
  EXPECT_EQUAL(found.odds.size(), 1u);
  EXPECT_NEAR(found.odds.at(1), 1, 1e-15);
  EXPECT_EQUAL(found.left_out, 0);
  EXPECT(found.runs < 10);
}

TEST("A loop that hardly ever ends is as exact as another") {
  const Outcomes found = outcomes_of([](DirectedDraws& AOS) {
    int side = 0;
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(side), std::tie()), side == 0) {
      side = AOS.SampleDiscrete(-1, {1.0, 1e-9, 3e-9});
    }
    return side;
  });
  EXPECT_NEAR(found.odds.at(1), 0.25, 1e-13);
  EXPECT_NEAR(found.odds.at(2), 0.75, 1e-13);
}

TEST("Nested loops, in a function that is called twice, do not mix their calls") {
  const auto roll = [](DirectedDraws& AOS, double again) {
    int outer = 0;
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(outer, again), std::tie()), outer == 0) {
      int inner = 0;
      DrawingLoop nested{AOS, 2};
      while (nested.head(std::tie(inner, outer, again), std::tie()), inner == 0) {
        inner = AOS.SampleDiscrete(-1, {0.5, 0.3, 0.2});
      }
      if (!AOS.Bernoulli(again)) outer = inner;
    }
    return outer;
  };
  const Outcomes found = outcomes_of([&](DirectedDraws& AOS) {
    const int first = roll(AOS, 0.25);
    return 10 * first + roll(AOS, 0.5);
  });
  EXPECT_NEAR(found.odds.at(11), 0.36, 1e-14);
  EXPECT_NEAR(found.odds.at(12), 0.24, 1e-14);
  EXPECT_NEAR(found.odds.at(21), 0.24, 1e-14);
  EXPECT_NEAR(found.odds.at(22), 0.16, 1e-14);
}

TEST("A loop that is entered twice without a draw between keeps its calls apart") {
  const auto wait = [](DirectedDraws& AOS, int& left) {
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(left), std::tie()), left > 0) left -= AOS.Bernoulli(0.5) ? 1 : 0;
  };
  const Outcomes found = outcomes_of([&](DirectedDraws& AOS) {
    int none = 0, some = 1;
    wait(AOS, none);
    const int mark = 7;
    wait(AOS, some);
    return mark + none + some;
  });
  EXPECT_NEAR(found.odds.at(7), 1, 1e-14);
}

TEST("A loop that counts its rounds is walked up to a negligible rest") {
  const Outcomes found = outcomes_of([](DirectedDraws& AOS) {
    int rounds = 0;
    bool goes_on = true;
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(rounds, goes_on), std::tie()), goes_on) {
      ++rounds;
      goes_on = AOS.Bernoulli(0.5);
    }
    return rounds;
  });
  EXPECT(found.left_out > 0);
  EXPECT(found.left_out <= aos::negligible_paths);
  for (int rounds = 1; rounds < 20; ++rounds) EXPECT_NEAR(found.odds.at(rounds), std::pow(0.5, rounds), 1e-15);
}

TEST("A loop that fills an array is walked without cuts where its rounds are too many to keep, each path once") {
  const auto fill = [](int count, int max_paths) {
    int ends = 0;
    const Outcomes found = outcomes_of(
        [&](DirectedDraws& AOS) {
          if (AOS.Bernoulli(0.25)) return -1;
          bool flags[20]{};
          int i = 0;
          DrawingLoop loop{AOS, 1};
          while (loop.head(std::tie(flags, i), std::tie()), i < count) flags[i++] = AOS.Bernoulli(0.5);
          int number = 0;
          for (const bool flag : flags) number = 2 * number + flag;
          return number;
        },
        nullptr, max_paths);
    for (const auto& [number, probability] : found.odds) {
      ends += number >= 0 && std::abs(probability - 0.75 / (1 << count)) < 1e-15;
    }
    EXPECT_NEAR(found.odds.at(-1), 0.25, 1e-15);
    EXPECT_EQUAL(found.left_out, 0);
    return ends;
  };
  EXPECT_EQUAL(fill(4, aos::path_budget), 1 << 4);
  EXPECT_EQUAL(fill(11, aos::path_budget), 1 << 11);
  EXPECT_EQUAL(fill(18, 1'000'000), 1 << 18);
}

// Leaves its loop with place 3, or stays in places 1 and 2 for ever.
int place_of_trap(DirectedDraws& AOS) {
  int place = 0;
  DrawingLoop loop{AOS, 1};
  while (loop.head(std::tie(place), std::tie()), place != 3) {
    place = place == 0 ? (AOS.Bernoulli(0.25) ? 1 : AOS.Bernoulli(0.2) ? 0 : 3) : (AOS.Bernoulli(0.5) ? 1 : 2);
  }
  return place;
}

TEST("Code that takes an endless path as an outcome is enumerated") {
  const auto caught = [](auto&& code) {
    return [code](DirectedDraws& AOS) {
      try {
        return code(AOS);
      } catch (const aos::EndlessPath&) {
        return -1;
      }
    };
  };
  const Outcomes found = outcomes_of(caught(place_of_trap));
  EXPECT_NEAR(found.odds.at(-1), 0.25 / 0.85, 1e-15);
  EXPECT_NEAR(found.odds.at(3), 0.6 / 0.85, 1e-15);
  EXPECT_EQUAL(found.left_out, 0);
  const Outcomes all = outcomes_of(caught([](DirectedDraws& AOS) {
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(), std::tie()), true) AOS.Bernoulli(0.5);
    return 0;
  }));
  EXPECT_NEAR(all.odds.at(-1), 1, 1e-15);
}

TEST("A loop that other numbers may end counts as endless for no numbers") {
  Enumerator draws;
  draws.leave_numbers_to(1);
  bool is_endless = false;
  const auto run = [&](Enumerator& path) {
    DirectedDraws& AOS = path;
    DrawingLoop loop{AOS, 1};
    try {
      while (loop.head(std::tie(), std::tie()), true) {
        if (AOS.SampleUniform(0, 1) > 0.999) return;
      }
    } catch (const aos::EndlessPath&) {
      is_endless = true;
    }
  };
  bool is_refused = false;
  try {
    draws.for_nearly_each_path(run, [](Enumerator&) {});
  } catch (const aos::NotEnumerable&) {
    is_refused = true;
  }
  EXPECT(is_refused && !is_endless);
}

TEST("A loop that never ends for some draws is not enumerated") {
  const auto enumerated = [](auto&& code) {
    try {
      outcomes_of(code);
      return true;
    } catch (const aos::NotEnumerable&) {
      return false;
    }
  };
  EXPECT(!enumerated([](DirectedDraws& AOS) {
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(), std::tie()), true) AOS.Bernoulli(0.5);
    return 0;
  }));
  EXPECT(!enumerated(place_of_trap));
}

TEST("Numbers that a loop reports weigh its ends") {
  aos::ObservedNumbers observed;
  observed.add(aos::number_key(0, 0), 0.0);
  aos::WeighedNumbers numbers{observed};
  const Outcomes found = outcomes_of(
      [](DirectedDraws& AOS) {
        int side = 0;
        DrawingLoop loop{AOS, 1};
        while (loop.head(std::tie(side), std::tie()), side == 0) {
          side = AOS.SampleDiscrete(-1, {0.5, 0.25, 0.25});
          if (side > 0) AOS.report(aos::number_key(0, 0), aos::Normal(side - 1.0, 1.0));
        }
        return side;
      },
      &numbers);
  const double density = std::exp(numbers.log_scale()) / std::sqrt(2 * std::acos(-1.0));
  EXPECT_NEAR(found.odds.at(1), 0.5 * density, 1e-12);
  EXPECT_NEAR(found.odds.at(2), 0.5 * density * std::exp(-0.5), 1e-12);
}

// --- random loops --------------------------------------------------------------------------------------------------------

// A machine with `places` places: each leads to some others, and an end is reached from some. It is drawn with a seed.
struct Machine {
  int places;
  aos::List<aos::List<double>> weights;  // of places, then of two ends

  explicit Machine(std::uint64_t seed) {
    aos::Sampler random{seed};
    places = 1 + random.below(12);
    for (int place = 0; place < places; ++place) {
      aos::List<double> row(static_cast<std::size_t>(places) + 2, 0.0);
      for (double& weight : row) weight = random.flag(0.3) ? random.uniform() : 0;
      row[static_cast<std::size_t>(random.below(places))] += random.uniform();
      row[static_cast<std::size_t>(places + random.below(2))] += 0.001 + random.uniform() * 0.05;
      double total = 0;
      for (const double weight : row) total += weight;
      for (double& weight : row) weight /= total;
      weights.push_back(row);
    }
  }

  // The probability of the first end, by Gauss' elimination of (I - P) x = r in long doubles.
  double first_end() const {
    const auto n = static_cast<std::size_t>(places);
    aos::List<aos::List<long double>> system(n, aos::List<long double>(n + 1));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) system[i][j] = (i == j ? 1.0L : 0.0L) - weights[i][j];
      system[i][n] = weights[i][n];
    }
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t best = k;
      for (std::size_t i = k + 1; i < n; ++i) {
        if (std::abs(system[i][k]) > std::abs(system[best][k])) best = i;
      }
      std::swap(system[k], system[best]);
      for (std::size_t i = 0; i < n; ++i) {
        if (i == k) continue;
        const long double factor = system[i][k] / system[k][k];
        for (std::size_t j = k; j <= n; ++j) system[i][j] -= factor * system[k][j];
      }
    }
    return static_cast<double>(system[0][n] / system[0][0]);
  }
};

TEST("Random machines end where linear equations say") {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Machine machine{seed};
    const Outcomes found = outcomes_of([&](DirectedDraws& AOS) {
      int place = 0;
      DrawingLoop loop{AOS, 1};
      while (loop.head(std::tie(place), std::tie()), place < machine.places) {
        place = AOS.SampleDiscrete(-1, machine.weights[static_cast<std::size_t>(place)]);
      }
      return place - machine.places;
    });
    double first = 0, total = 0;
    for (const auto& [end, probability] : found.odds) {
      total += probability;
      if (end == 0) first = probability;
    }
    EXPECT_EQUAL(found.left_out, 0);
    EXPECT_NEAR(total, 1, 1e-12);
    EXPECT_NEAR(first, machine.first_end(), 1e-11);
  }
}

TEST("A walk over a grid of 2500 cells until it meets a corner is eliminated") {
  constexpr int side = 50;
  const Outcomes found = outcomes_of([](DirectedDraws& AOS) {
    int x = side / 2, y = side / 2;
    DrawingLoop loop{AOS, 1};
    while (loop.head(std::tie(x, y), std::tie()), !((x == 0 || x == side) && (y == 0 || y == side))) {
      switch (AOS.SampleDiscrete(-1, {0.25, 0.25, 0.25, 0.25})) {
        case 0: x = x == 0 ? 1 : x - 1; break;
        case 1: x = x == side ? side - 1 : x + 1; break;
        case 2: y = y == 0 ? 1 : y - 1; break;
        default: y = y == side ? side - 1 : y + 1;
      }
    }
    return 2 * (x == 0 ? 0 : 1) + (y == 0 ? 0 : 1);
  }, nullptr, 100'000);
  for (int corner = 0; corner < 4; ++corner) EXPECT_NEAR(found.odds.at(corner), 0.25, 1e-11);
}

}
