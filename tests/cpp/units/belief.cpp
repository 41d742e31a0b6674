// Beliefs: belief.hpp and gathering.hpp.
#include "aos/belief/belief.hpp"

#include <map>

#include "check.hpp"
#include "worlds.hpp"

namespace units::belief_tests {

double weight_of(const Belief& belief, std::uint32_t state) {
  double weight = 0;
  for (const auto& particle : belief.particles()) {
    if (TableModel::number_of(particle.state) == state) weight += particle.weight;
  }
  return weight;
}

TEST("The posterior is Bayes' rule, and comes with the probability of what was observed") {
  const Problem tiger = units::tiger();
  const Belief initial = initial_belief(tiger);
  aos::Sampler random{1};
  const auto [once, first] = exam::posterior_of(initial, 0, 0, random);
  EXPECT_NEAR(first, 0.5, 1e-12);
  EXPECT_NEAR(weight_of(once, 0), 0.85, 1e-12);
  const auto [twice, second] = exam::posterior_of(once, 0, 0, random);
  EXPECT_NEAR(second, 0.85 * 0.85 + 0.15 * 0.15, 1e-12);
  EXPECT_NEAR(weight_of(twice, 0), 0.85 * 0.85 / (0.85 * 0.85 + 0.15 * 0.15), 1e-12);
  EXPECT(twice.is_exact());
}

TEST("What cannot be observed leaves an empty belief, and has probability 0") {
  const Problem tiger = units::tiger();
  aos::Sampler random{1};
  const auto [posterior, probability] = exam::posterior_of(initial_belief(tiger), 0, 5, random);
  EXPECT(posterior.particles().empty());
  EXPECT_EQUAL(probability, 0.0);
}

TEST("States that come to be equal are one particle with both weights") {
  Problem problem = world(3, 1, 0.9);
  problem.starts = {{0, 0.25}, {1, 0.75}};
  row(problem, 0, 0) = {{0.5, 2, 0, 0}, {0.5, 1, 0, 0}};
  row(problem, 1, 0) = {{1.0, 2, 0, 0}};
  aos::Sampler random{1};
  const Belief next = initial_belief(problem).predicted(0, random);
  EXPECT_EQUAL(next.particles().size(), 2u);
  EXPECT_NEAR(weight_of(next, 2), 0.875, 1e-12);
  EXPECT_NEAR(weight_of(next, 1), 0.125, 1e-12);
}

TEST("Observations come with their probabilities, the likeliest first") {
  Problem problem = world(2, 1, 0.9);
  problem.starts = {{0, 0.25}, {1, 0.75}};
  problem.sensings = {{{3, 0.5}, {4, 0.5}}, {{4, 0.9}, {-1, 0.1}}};
  row(problem, 1, 0) = {{1.0, 1, 1, 0}};
  aos::Sampler random{1};
  const auto odds = initial_belief(problem).observations(0, random);
  EXPECT_EQUAL(odds.size(), 3u);
  EXPECT_EQUAL(odds[0].first, 4);
  EXPECT_NEAR(odds[0].second, 0.25 * 0.5 + 0.75 * 0.9, 1e-12);
  EXPECT_EQUAL(odds[1].first, 3);
  EXPECT_NEAR(odds[1].second, 0.125, 1e-12);
  EXPECT_EQUAL(odds[2].first, -1);
  EXPECT_NEAR(odds[2].second, 0.075, 1e-12);
}

TEST("A state that has ended stays in the belief, and is told by how it ended") {
  const Problem corridor = units::corridor(1, 0.9);
  aos::Sampler random{1};
  const Belief over = initial_belief(corridor).predicted(0, random);
  EXPECT_NEAR(over.probability_of(aos::Ending::goal), 1.0, 1e-12);
  EXPECT_NEAR(over.predicted(1, random).probability_of(aos::Ending::goal), 1.0, 1e-12);
}

TEST("A mixture has the weights of both beliefs in their shares") {
  const Problem tiger = units::tiger();
  const Belief initial = initial_belief(tiger);
  aos::Sampler random{1};
  const Belief sure = exam::posterior_of(initial, 0, 1, random).first;
  EXPECT_NEAR(weight_of(initial.mixed_with(sure, 0.4), 1), 0.6 * 0.5 + 0.4 * 0.85, 1e-12);
}

TEST("Draws from a belief follow its weights") {
  Problem problem = world(3, 1, 0.9);
  problem.starts = {{0, 0.2}, {1, 0.3}, {2, 0.5}};
  const Belief belief = initial_belief(problem);
  aos::Sampler random{7};
  std::map<std::uint32_t, int> drawn;
  constexpr int draws = 40'000;
  for (int i = 0; i < draws; ++i) ++drawn[TableModel::number_of(belief.sample(random))];
  EXPECT_NEAR(drawn[0] / double{draws}, 0.2, 0.01);
  EXPECT_NEAR(drawn[1] / double{draws}, 0.3, 0.01);
}

TEST("Thinning out keeps heavy states as they are, tells what it drops, and changes no weight on average") {
  Problem problem = world(200, 1, 0.9);
  aos::List<TableModel::State> states;
  start_evenly(problem, 0, 200);
  const Belief initial = initial_belief(problem);  // outlives the loop over its particles
  aos::Sampler random{3};
  for (const auto& particle : initial.particles()) states.push_back(particle.state);
  aos::List<double> sums(200, 0.0);
  constexpr int rounds = 4000;
  for (int round = 0; round < rounds; ++round) {
    aos::Gathering<TableModel> gathering;
    double total = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const double weight = i == 0 ? 50 : 1 + i % 5;
      gathering.add(states[i], weight);
      total += weight;
    }
    const double gone = gathering.reduce(40, random);
    EXPECT(gathering.size() <= 41);
    double kept = 0;
    double overlap = 0;
    for (const auto& [state, weight] : gathering.particles()) {
      const std::uint32_t number = TableModel::number_of(state);
      const double before = number == 0 ? 50 : 1 + number % 5;
      sums[number] += weight;
      kept += weight;
      overlap += std::min(weight, before);
      if (number == 0) EXPECT_NEAR(weight, 50, 1e-9);
    }
    EXPECT(total - overlap <= gone + 1e-9);
    EXPECT(std::abs(kept - total) <= 20);
  }
  for (std::uint32_t number = 0; number < 200; number += 13) {
    const double before = number == 0 ? 50 : 1 + number % 5;
    EXPECT_NEAR(sums[number] / rounds, before, 0.1 * before);
  }
}

TEST("Thinning out does not agree with a pattern in the order of the states") {
  aos::Sampler random{5};
  for (const double share : {0.25, 0.5}) {
    aos::List<double> weights(4000, 1.0);
    aos::thin_out(weights, static_cast<std::size_t>(share * 4000), random);
    double even = 0;
    double all = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      even += i % 2 == 0 ? weights[i] : 0;
      all += weights[i];
    }
    EXPECT_NEAR(all, 4000, 1e-6);
    EXPECT_NEAR(even / all, 0.5, 0.07);  // at even distances it is 0 or 1
  }
}

TEST("States drawn by their weights do not agree with a pattern in their order") {
  Problem problem = world(4000, 1, 0.9);
  start_evenly(problem, 0, 4000);
  const Belief belief = initial_belief(problem);
  aos::Sampler random{6};
  int even = 0;
  aos::draw_evenly<TableModel>(belief.particles(), 2000, random, [&](const TableModel::State& state) {
    even += TableModel::number_of(state) % 2 == 0 ? 1 : 0;
  });
  EXPECT_NEAR(even / 2000.0, 0.5, 0.07);
}

TEST("The error bound holds how far a belief with too many states is from the exact one") {
  constexpr std::uint32_t many = 120'000;
  Problem problem = world(many, 1, 0.9);
  problem.starts.clear();
  double total = 0;
  for (std::uint32_t state = 0; state < many; ++state) {
    problem.values[2 * state] = static_cast<int>(state % 1000);
    problem.values[2 * state + 1] = static_cast<int>(state / 1000);
    total += 1.0 / (1 + state);
  }
  for (std::uint32_t state = 0; state < many; ++state) problem.starts.push_back({state, 1.0 / (1 + state) / total});
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  EXPECT(belief.particles().size() < many);
  EXPECT(!belief.is_exact());
  double overlap = 0;
  for (const auto& [state, weight] : belief.particles()) {
    overlap += std::min(weight, problem.starts[TableModel::number_of(state)].probability);
  }
  EXPECT(1 - overlap > 0);
  EXPECT(1 - overlap <= belief.error_bound() + 1e-9);
}

}
