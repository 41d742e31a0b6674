// Draws and the walk over all of them: enumerator.hpp, normal.hpp, random.hpp.
#include "aos/draws/enumerator.hpp"

#include <set>

#include "aos/draws/normal.hpp"
#include "aos/model/support.hpp"
#include "check.hpp"

namespace units::enumeration_tests {

using namespace aos;

struct Walked {
  double walked = 0;
  double left_out = 1;
  bool has_ended = true;
};

template <class Code>
Walked walked(Code&& code) {
  Walked result;
  Enumerator draws;
  try {
    result.left_out = draws.for_nearly_each_path(code, [&](Enumerator& path) {
      result.walked += path.probability();
    });
  } catch (const NotEnumerable&) {
    result.has_ended = false;
  }
  return result;
}

struct Weather {
  Ending aos_ending = Ending::running;
  int sky = 0;
  bool is_seen = false;
};

// The sky has 30 draws, and to look has one.
struct Outside : EnvironmentDefaults {
  struct aos_Chosen {
    aos_Chosen(auto&&...) {}
  };
  static constexpr bool has_extrinsic_changes = true;
  static void extrinsic_changes(const Weather&, Weather& next, double&, int, const auto&, auto& draws) {
    for (int i = 0; i < 30; ++i) next.sky = 2 * next.sky + draws.Bernoulli(0.5);
  }
};
struct Look : SkillDefaults {
  static constexpr std::array<const char*, 0> response_names{};
  static void next_state(const auto&, const auto&, Weather& next, bool, int, auto&, const auto&, auto& draws) { next.is_seen = draws.Bernoulli(0.3); }
};

TEST("Where luck makes the draws of the world, those of the skill are walked in one world") {
  std::set<std::pair<int, bool>> seen;
  Enumerator draws;
  double walked = 0;
  for (std::uint64_t luck = 1; luck <= 3; ++luck) {
    Weather weather;
    draws.leave_world_to(luck);
    const auto code = [&](Enumerator& path) {
      weather = {};
      step<Outside, Look>(weather, SkillDefaults::aos_Parameters{}, static_cast<DirectedDraws&>(path));
    };
    draws.for_nearly_each_path(code, [&](Enumerator& path) {
      walked += path.probability();
      seen.emplace(weather.sky, weather.is_seen);
    });
  }
  EXPECT(std::abs(walked - 3) < 1e-12);
  EXPECT(seen.size() == 6);
  std::set<int> worlds;
  for (const auto& [sky, is_seen] : seen) worlds.insert(sky);
  EXPECT(worlds.size() == 3);
}

TEST("The paths of loops that draw sum to 1, whether the way out comes first or last") {
  const auto check = [](const char* name, Walked result) {
    const bool is_all = std::abs(result.walked + result.left_out - 1) < 1e-11 && result.left_out <= max_left_out;
    EXPECT_THAT(result.has_ended && is_all, std::string{name} + ": the paths do not sum to 1");
  };
  check("exit first", walked([](auto& draws) {
          while (draws.Bernoulli(0.5)) {
          }
        }));
  check("exit last", walked([](auto& draws) {
          while (!draws.Bernoulli(0.5)) {
          }
        }));
  check("a rare exit first", walked([](auto& draws) {
          while (draws.Bernoulli(0.1) ? false : true) {
          }
        }));
  check("a rare exit last", walked([](auto& draws) {
          while (draws.Bernoulli(0.9) ? true : false) {
          }
        }));
  check("one after another", walked([](auto& draws) {
          for (int loop = 0; loop < 3; ++loop) {
            while (true) {
              if (!draws.Bernoulli(0.3)) break;
            }
          }
        }));
  check("nested", walked([](auto& draws) {
          while (true) {
            while (draws.Bernoulli(0.05)) {
            }
            if (draws.Bernoulli(0.95)) break;
          }
        }));
  const Walked flips = walked([](auto& draws) {
    for (int i = 0; i < 12; ++i) draws.Bernoulli(0.5);
  });
  EXPECT_THAT(flips.has_ended && flips.left_out == 0, "4096 paths are all walked");
}

TEST("Endless loops and crowds of paths are given up") {
  const Walked endless = walked([](auto& draws) {
    while (draws.SampleDiscrete(std::initializer_list<double>{0.5, 0.5}) < 2) {
    }
  });
  EXPECT_THAT(!endless.has_ended, "an endless loop is given up");
  const Walked crowd = walked([](auto& draws) {
    for (int i = 0; i < 40; ++i) draws.Bernoulli(0.5);
  });
  EXPECT_THAT(!crowd.has_ended, "2^40 paths are given up");
}

TEST("Strata of a continuous draw have the whole probability, in the middle and at both ends") {
  for (const DrawStrata strata : {DrawStrata::of(fine_strata), DrawStrata::of(middling_strata), DrawStrata::of(coarse_strata)}) {
    for (const double mark : {-3.5, -2.0, -0.4, 0.0, 1.1, 2.5, 3.8}) {
      double above = 0, all = 0;
      Enumerator draws;
      draws.divide_numbers(strata);
      bool is_above = false;
      draws.for_each_path([&](Enumerator& path) { is_above = path.SampleNormal(0, 1) > mark; },
                          [&](Enumerator& path) {
                            all += path.probability();
                            if (is_above) above += path.probability();
                          });
      const double truth = 0.5 * std::erfc(mark / std::sqrt(2.0));
      EXPECT_THAT(std::abs(all - 1) < 1e-12, "the strata do not sum to 1");
      EXPECT_THAT(std::abs(above - truth) <= 2 * strata.error(), "the probability above " + std::to_string(mark));
      if (strata.count > 15) EXPECT_THAT(above > truth / 2 && 1 - above > (1 - truth) / 2, "an end above " + std::to_string(mark));
    }
  }
}

TEST("One of 5000 weights is drawn where it is nearly all") {
  Sampler random{1};
  aos::List<double> weights(5000, 1e-9);
  weights[4321] = 1;
  EXPECT_THAT(random.SampleDiscrete(-1, weights) == 4321, "5000 weights");
}

TEST("Weights that sum to more than 1 are divided, and what is missing to 1 gives -1") {
  Sampler random{1};
  int last = 0;
  int none = 0;
  for (int i = 0; i < 3000; ++i) {
    last += random.SampleDiscrete(aos::List<double>{1, 1, 1}) == 2 ? 1 : 0;
    none += random.SampleDiscrete(aos::List<double>{0.25, 0.25}) == -1 ? 1 : 0;
  }
  EXPECT_THAT(std::abs(last - 1000) < 130 && std::abs(none - 1500) < 140, "five standard deviations");
}

TEST("Normal quantiles are those of the normal distribution") {
  for (const double probability : {1e-12, 1e-5, 0.01, 0.3, 0.5, 0.8, 0.999, 1 - 1e-9}) {
    const double back = 0.5 * std::erfc(-normal_quantile(probability) / std::sqrt(2.0));
    EXPECT_THAT(std::abs(back - probability) < 1e-12 + 1e-9 * probability, "the quantile of " + std::to_string(probability));
  }
}

}
