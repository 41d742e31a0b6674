// Checks of the headers that beliefs are made of, against what is known of small models written here. Prints what does not
// hold, and ends with 1 then.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/normal.hpp"
#include "aos/belief/guided_step.hpp"
#include "aos/belief/particle_filter.hpp"
#include "aos/model/support.hpp"

namespace {

using namespace aos;

int mistakes = 0;
void expect(bool holds, const std::string& what) {
  if (holds) return;
  std::printf("%s\n", what.c_str());
  ++mistakes;
}

// --- enumeration ---------------------------------------------------------------------------------------------------------

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

void loops_are_walked_in_either_order() {
  const auto check = [](const char* name, Walked result) {
    const bool is_all = std::abs(result.walked + result.left_out - 1) < 1e-11 && result.left_out <= max_left_out;
    expect(result.has_ended && is_all, std::string{name} + ": the paths do not sum to 1");
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
  expect(flips.has_ended && flips.left_out == 0, "4096 paths are all walked");
}

void endless_loops_and_crowds_of_paths_are_given_up() {
  const Walked endless = walked([](auto& draws) {
    while (draws.SampleDiscrete(std::initializer_list<double>{0.5, 0.5}) < 2) {
    }
  });
  expect(!endless.has_ended, "an endless loop is given up");
  const Walked crowd = walked([](auto& draws) {
    for (int i = 0; i < 40; ++i) draws.Bernoulli(0.5);
  });
  expect(!crowd.has_ended, "2^40 paths are given up");
}

void many_weights_are_drawn_from() {
  Sampler random{1};
  std::vector<double> weights(5000, 1e-9);
  weights[4321] = 1;
  expect(random.SampleDiscrete(-1, weights) == 4321, "5000 weights");
}

void normal_quantiles_are_those_of_the_normal_distribution() {
  for (const double probability : {1e-12, 1e-5, 0.01, 0.3, 0.5, 0.8, 0.999, 1 - 1e-9}) {
    const double back = 0.5 * std::erfc(-normal_quantile(probability) / std::sqrt(2.0));
    expect(std::abs(back - probability) < 1e-12 + 1e-9 * probability, "the quantile of " + std::to_string(probability));
  }
}

// --- guided steps --------------------------------------------------------------------------------------------------------

// Eight noisy distances, each a letter of the response.
struct Beams {
  struct State {
    int distances[8];
    bool operator==(const State&) const = default;
  };
  template <class Random>
  static Step step(State& state, int, Random& random) {
    EffectWithText effect;
    const ShownText shown{effect};
    effect.text = "";
    for (const int distance : state.distances) effect.text += letter(distance - std::abs(random.SampleNormal(0, 2.5)));
    return {0, text_observation(effect.text)};
  }
  static char letter(double noisy) { return static_cast<char>('a' + std::max(0, static_cast<int>(std::floor(noisy)))); }

  static double probability(int distance, char seen) {
    const int likelihood = seen - 'a';
    const auto within = [](double deviations) { return std::erf(deviations / std::sqrt(2.0)); };
    const double upper = likelihood == 0 ? 1 : within((distance - likelihood) / 2.5);
    return upper - within(std::max(distance - likelihood - 1, 0) / 2.5);
  }
};

// The same, but the text is assigned anew in the end, so that its beginnings mislead.
struct LateBeams : Beams {
  template <class Random>
  static Step step(State& state, int, Random& random) {
    EffectWithText effect;
    const ShownText shown{effect};
    effect.text = "x";
    const bool is_on = random.Bernoulli(0.5);
    const bool is_seen = random.Bernoulli(is_on ? 0.9 : 0.2);
    effect.text = is_seen ? "yes" : "no";
    state.distances[0] = is_on;
    return {0, text_observation(effect.text)};
  }
};

template <class Model>
double mean_weight(const typename Model::State& state, Observation seen, int trials, double& relative_deviation) {
  Sampler random{7};
  GuidedStep<Model> guided{0, seen, nullptr, random};
  double sum = 0;
  double squares = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const double weight = guided.from(state, [](const auto&, double, const auto&) {});
    sum += weight;
    squares += weight * weight;
  }
  const double mean = sum / trials;
  relative_deviation = std::sqrt(std::max(squares / trials - mean * mean, 0.0)) / mean;
  return mean;
}

void texts_of_eight_continuous_draws_are_weighed_without_bias() {
  Sampler random{3};
  for (int model = 0; model < 8; ++model) {
    Beams::State state;
    for (int& distance : state.distances) distance = 1 + random.below(8);
    const Observation seen = Beams::step(state, 0, random).observation;
    double exact = 1;
    for (int beam = 0; beam < 8; ++beam) exact *= Beams::probability(state.distances[beam], observation_text(seen)[beam]);
    double deviation = 0;
    const double mean = mean_weight<Beams>(state, seen, 200, deviation);
    expect(std::abs(mean / exact - 1) < 0.03, "the weight of " + std::string{observation_text(seen)});
    expect(deviation < 0.3, "the deviation of the weight of " + std::string{observation_text(seen)});
  }
}

void a_text_that_is_assigned_anew_is_weighed_without_bias() {
  double deviation = 0;
  const double mean = mean_weight<LateBeams>({}, text_observation("yes"), 20'000, deviation);
  expect(std::abs(mean - 0.55) < 0.02, "a text assigned anew has weight " + std::to_string(mean));
}

// --- particles -----------------------------------------------------------------------------------------------------------

// Forty cards, dealt in the beginning, of which each step turns one; noise tells all particles apart.
struct Cards {
  static constexpr int count = 40;
  struct State {
    std::uint64_t cards = 0;
    double noise = 0;
    int turned = 0;
    bool operator==(const State&) const = default;
  };
  template <class Random>
  static void initial(State& state, Random& random) {
    state = {};
    for (int card = 0; card < count; ++card) state.cards |= std::uint64_t{random.Bernoulli(0.5)} << card;
  }
  static std::uint64_t hash(const State& state) {
    return (state.cards ^ std::bit_cast<std::uint64_t>(state.noise)) * 0x9e3779b97f4a7c15u;
  }
  template <class Random>
  static Step step(State& state, int, Random& random) {
    state.noise = random.SampleUniform(0, 1);
    return {0, static_cast<Observation>(state.cards >> state.turned++ & 1)};
  }
};

void what_is_not_turned_yet_stays_open() {
  Sampler random{5};
  ParticleFilter<Cards> filter{random};
  Cloud<Cards> cloud = filter.initial();
  double distance = 0;
  for (int card = 0; card < Cards::count; ++card) {
    const HistoryStep step{.action = 0, .observation = card % 3 == 0, .is_observed = true};
    auto [after, probability] = filter.after(std::move(cloud), step, ignored_numbers);
    distance += std::abs(probability - 0.5) / Cards::count;
    expect(std::abs(probability - 0.5) < 0.49, "card " + std::to_string(card) + ": " + std::to_string(probability));
    expect(after.effective() >= 50, "card " + std::to_string(card) + ": few effective");
    for (const auto& particle : after.particles) {
      for (int turned = 0; turned <= card; ++turned) {
        expect((particle.state.cards >> turned & 1) == (turned % 3 == 0), "a card that was turned is another one");
      }
    }
    cloud = std::move(after);
  }
  expect(distance < 0.06, "the next card is open, on average, but for " + std::to_string(distance));
}

// Of 35 cards 30 are turned. Then five more are turned at once, all of them face up. One state is left then, so that no
// move can make up for samples that were lost.
struct Hand : Cards {
  template <class Random>
  static void initial(State& state, Random& random) {
    Cards::initial(state, random);
    state.cards &= (std::uint64_t{1} << 35) - 1;
  }
  template <class Random>
  static Step step(State& state, int, Random&) {
    if (state.turned < 30) return {0, static_cast<Observation>(state.cards >> state.turned++ & 1)};
    return {0, state.cards >> 30 == 31 ? 1 : 0};
  }
};

void a_rare_observation_after_a_long_history_leaves_many_samples() {
  Sampler random{5};
  ParticleFilter<Hand> filter{random};
  Cloud<Hand> cloud = filter.initial();
  for (int step = 0; step <= 30; ++step) {
    const HistoryStep seen{.action = 0, .observation = 1, .is_observed = true};
    cloud = filter.after(std::move(cloud), seen, ignored_numbers).cloud;
  }
  expect(cloud.particles.size() == 1, "one state is left");
  expect(cloud.effective() >= 100, "a rare observation leaves " + std::to_string(cloud.effective()) + " samples");
}

}  // namespace

int main() {
  loops_are_walked_in_either_order();
  endless_loops_and_crowds_of_paths_are_given_up();
  many_weights_are_drawn_from();
  normal_quantiles_are_those_of_the_normal_distribution();
  texts_of_eight_continuous_draws_are_weighed_without_bias();
  a_text_that_is_assigned_anew_is_weighed_without_bias();
  what_is_not_turned_yet_stays_open();
  a_rare_observation_after_a_long_history_leaves_many_samples();
  return mistakes == 0 ? 0 : 1;
}
