// Samples that are weighed by what was observed: guided_step.hpp, particle_filter.hpp.
#include "aos/belief/particle_filter.hpp"

#include "aos/belief/guided_step.hpp"
#include "aos/model/support.hpp"
#include "check.hpp"

namespace units::particles_tests {

using namespace aos;

// Eight noisy distances, each a letter of the response. Or a text that is assigned anew in the end, so that its beginnings
// mislead.
struct Beams {
  inline static bool is_assigned_anew = false;
  struct State {
    int distances[8];
    bool operator==(const State&) const = default;
  };
  template <class Random>
  static Step step(State& state, int, Random& random) {
    EffectWithText effect;
    const ShownText shown{effect};
    effect.text = is_assigned_anew ? "x" : "";
    if (is_assigned_anew) {
      const bool is_on = random.Bernoulli(0.5);
      const bool is_seen = random.Bernoulli(is_on ? 0.9 : 0.2);
      effect.text = is_seen ? "yes" : "no";
      state.distances[0] = is_on;
      return {0, text_observation(effect.text)};
    }
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

double mean_weight(const Beams::State& state, Observation seen, int trials, double& relative_deviation) {
  Sampler random{7};
  GuidedStep<Beams> guided{0, seen, nullptr, random};
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

TEST("Texts of eight continuous draws are weighed without bias") {
  Beams::is_assigned_anew = false;
  Sampler random{3};
  for (int model = 0; model < 8; ++model) {
    Beams::State state;
    for (int& distance : state.distances) distance = 1 + random.below(8);
    const Observation seen = Beams::step(state, 0, random).observation;
    double exact = 1;
    for (int beam = 0; beam < 8; ++beam) exact *= Beams::probability(state.distances[beam], observation_text(seen)[beam]);
    double deviation = 0;
    const double mean = mean_weight(state, seen, 200, deviation);
    EXPECT_THAT(std::abs(mean / exact - 1) < 0.03, "the weight of " + std::string{observation_text(seen)});
    EXPECT_THAT(deviation < 0.3, "the deviation of the weight of " + std::string{observation_text(seen)});
  }
}

TEST("A text that is assigned anew is weighed without bias") {
  Beams::is_assigned_anew = true;
  double deviation = 0;
  const double mean = mean_weight({}, text_observation("yes"), 20'000, deviation);
  EXPECT_THAT(std::abs(mean - 0.55) < 0.02, "a text assigned anew has weight " + std::to_string(mean));
}

// Forty cards, dealt in the beginning.
struct Cards {
  static constexpr int count = 40;
  enum class Game {
    turn,  // Each step turns the next card; noise tells all particles apart.
    hand,  // Of 35 cards 30 are turned. Then it is told whether the five others are all face up: rarely.
    show,  // Each step shows a card that was drawn, and says of it what is true in four of five cases.
  };
  inline static Game game = Game::turn;
  struct State {
    std::uint64_t cards = 0;
    double noise = 0;
    int turned = 0;
    bool operator==(const State&) const = default;
  };
  static std::size_t bytes_elsewhere() { return 0; }
  template <class Random>
  static void initial(State& state, Random& random) {
    state = {};
    for (int card = 0; card < count; ++card) state.cards |= std::uint64_t{random.Bernoulli(0.5)} << card;
    if (game == Game::hand) state.cards &= (std::uint64_t{1} << 35) - 1;
  }
  static std::uint64_t hash(const State& state) {
    return (state.cards ^ std::bit_cast<std::uint64_t>(state.noise)) * 0x9e3779b97f4a7c15u;
  }
  template <class Random>
  static Step step(State& state, int, Random& random) {
    if (game == Game::show) {
      state.turned = (state.turned + (random.Bernoulli(0.5) ? 1 : 2)) % count;
      const bool is_true = random.Bernoulli(0.8);
      return {0, static_cast<Observation>((state.cards >> state.turned & 1) == is_true)};
    }
    if (game == Game::hand && state.turned == 30) return {0, state.cards >> 30 == 31 ? 1 : 0};
    if (game == Game::turn) state.noise = random.SampleUniform(0, 1);
    return {0, static_cast<Observation>(state.cards >> state.turned++ & 1)};
  }
};

TEST("What particles have not observed yet stays open") {
  Cards::game = Cards::Game::turn;
  Sampler random{5};
  ParticleFilter<Cards> filter{random};
  Cloud<Cards> cloud = filter.initial();
  double distance = 0;
  for (int card = 0; card < Cards::count; ++card) {
    const HistoryStep step{.action = 0, .observation = card % 3 == 0, .is_observed = true};
    auto [after, probability] = filter.after(std::move(cloud), step, ignored_numbers);
    distance += std::abs(probability - 0.5) / Cards::count;
    EXPECT_THAT(std::abs(probability - 0.5) < 0.49, "card " + std::to_string(card) + ": " + std::to_string(probability));
    EXPECT_THAT(after.effective() >= 50, "card " + std::to_string(card) + ": few effective");
    for (const auto& particle : after.particles) {
      for (int turned = 0; turned <= card; ++turned) {
        EXPECT_THAT((particle.state.cards >> turned & 1) == (turned % 3 == 0), "a card that was turned is another one");
      }
    }
    cloud = std::move(after);
  }
  EXPECT_THAT(distance < 0.06, "the next card is open, on average, but for " + std::to_string(distance));
}

TEST("A rare observation after a long history leaves many samples") {
  Cards::game = Cards::Game::hand;
  Sampler random{5};
  ParticleFilter<Cards> filter{random};
  Cloud<Cards> cloud = filter.initial();
  for (int step = 0; step <= 30; ++step) {
    const HistoryStep seen{.action = 0, .observation = 1, .is_observed = true};
    cloud = filter.after(std::move(cloud), seen, ignored_numbers).cloud;
  }
  EXPECT_THAT(cloud.particles.size() == 1, "one state is left, so that no move can make up for samples that were lost");
  EXPECT_THAT(cloud.effective() >= 100, "a rare observation leaves " + std::to_string(cloud.effective()) + " samples");
}

TEST("Moves that keep the states which particles have passed are those that repeat all") {
  Cards::game = Cards::Game::show;
  Sampler random{5};
  ParticleFilter<Cards> filter{random};
  Cloud<Cards> cloud = filter.initial();
  for (int step = 0; step < 6; ++step) {
    const HistoryStep seen{.action = 0, .observation = step % 2 == 0, .is_observed = true};
    cloud = filter.after(std::move(cloud), seen, ignored_numbers).cloud;
  }
  EXPECT_THAT(cloud.history.steps()[0].is_guided, "steps are guided");
  aos::List<Cloud<Cards>> moved;
  aos::List<std::size_t> steps;
  for (const std::size_t bytes : {max_passage_bytes, std::size_t{0}}) {
    Sampler draws{7};
    Moves<Cards> moves{cloud.history, draws, bytes};
    moved.push_back(moves.moved(cloud));
    steps.push_back(moves.steps());
  }
  const auto same = [](const auto& one, const auto& other) { return one.state == other.state && one.weight == other.weight; };
  EXPECT_THAT(std::ranges::equal(moved[0].particles, moved[1].particles, same), "the same states");
  EXPECT_THAT(moved[0].effective() != cloud.effective(), "particles were moved");
  EXPECT_THAT(steps[0] < steps[1], "fewer steps are made");
}

}
