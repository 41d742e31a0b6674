// The model as numbers and what is worked out from it: state_space.hpp, step_table.hpp, exact.hpp.
#include "aos/planning/listed/state_space.hpp"

#include "aos/planning/listed/step_table.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::state_space_tests {

using Space = aos::StateSpace<TableModel>;

// The states that a problem's first belief leads to. The problem is the model from then on, as long as it lives.
struct Listed {
  explicit Listed(const Problem& problem) : belief{initial_belief(problem)} { EXPECT(space.reach(belief)); }
  Belief belief;
  Space space;
};

TEST("All states that can be reached are listed, and no others") {
  Problem problem = corridor(6, 0.9);
  problem.starts = {{2, 1.0}};
  row(problem, 1, 1) = {{1.0, 1, 0, 0.0}};  // cell 0 cannot be reached
  auto [belief, space] = Listed{problem};
  EXPECT(space.is_closed());
  EXPECT_EQUAL(space.size(), 5u);
  EXPECT(space.reaches(aos::Ending::goal));
  EXPECT(!space.reaches(aos::Ending::failure));
}

TEST("A drawn belief is listed, unless most of its states were drawn only once") {
  Problem few = corridor(6, 0.9);
  few.starts = {{0, 0.7}, {2, 0.2}, {4, 0.1}};
  Problem many = world(20000, 1, 0.9);
  start_evenly(many, 0, 20'000);
  aos::Sampler random{1};
  TableModel::take(few);
  Space space;
  EXPECT(space.reach(Belief::drawn(random)));
  TableModel::take(many);
  Space other;
  EXPECT(!other.reach(Belief::drawn(random)));
  EXPECT_EQUAL(other.obstacle(), std::string{"nearly all states of the belief differ"});
}

TEST("A row has the expected reward and the probabilities of the states after it; an ended one has no number") {
  Problem problem = world(3, 1, 0.9);
  problem.endings[2] = 2;
  row(problem, 0, 0) = {{0.25, 1, 0, 4.0}, {0.25, 1, 0, 0.0}, {0.5, 2, 0, -6.0}};
  auto [belief, space] = Listed{problem};
  EXPECT_EQUAL(space.size(), 2u);
  const std::uint32_t start = space.find(belief.particles().front().state);
  const auto& rows = space.rows();
  EXPECT_NEAR(rows.rewards[rows.row(start, 0)], 0.25 * 4 - 0.5 * 6, 1e-12);
  const auto outcomes = rows.outcomes[rows.row(start, 0)];
  EXPECT_EQUAL(outcomes.size(), 1u);
  EXPECT_NEAR(outcomes[0].probability, 0.5, 1e-12);
  EXPECT_EQUAL(space[outcomes[0].next].variables[0], 1);
}

TEST("Outcomes in the same next state share their likelihoods, which sum to 1") {
  const Problem tiger = units::tiger();
  auto [belief, space] = Listed{tiger};
  const auto& rows = space.rows();
  for (std::size_t row = 0; row < rows.states * rows.actions; ++row) {
    double total = 0;
    for (const auto& outcome : rows.outcomes[row]) {
      total += outcome.probability;
      double likelihoods = 0;
      for (const auto& likelihood : rows.likelihoods[outcome.sensing]) likelihoods += likelihood.probability;
      EXPECT_NEAR(likelihoods, 1.0, 1e-12);
    }
    EXPECT_NEAR(total, 1.0, 1e-12);
  }
}

TEST("Variables that do not matter tell no states apart, and all others do") {
  Problem problem = world(6, 1, 0.9);
  for (std::uint32_t state = 0; state < 6; ++state) {
    problem.values[2 * state] = static_cast<int>(state % 2);
    problem.values[2 * state + 1] = static_cast<int>(state / 2);
    row(problem, state, 0) = {{1.0, (state + 1) % 6, 0, state % 2 == 0 ? 1.0 : 0.0}};
  }
  EXPECT_EQUAL(Listed{problem}.space.size(), 6u);
  problem.irrelevant = {1};
  EXPECT_EQUAL(Listed{problem}.space.size(), 2u);
}

TEST("A limit that is met leaves nothing listed, and is told") {
  const Problem problem = corridor(50, 0.9);
  const Belief belief = initial_belief(problem);
  Space space{aos::ListLimits{.states = 10}};
  EXPECT(!space.reach(belief));
  EXPECT_EQUAL(space.size(), 0u);
  EXPECT(space.obstacle().find("too many states") != std::string::npos);
  Space work{aos::ListLimits{.work = 20}};
  EXPECT(!work.reach(belief));
  EXPECT(!work.obstacle().empty());
}

TEST("A list that will take far more work than its limit is given up early") {
  constexpr std::uint32_t states = 20'000;
  Problem many = world(states, 1, 0.9);
  start_evenly(many, 0, states);
  const Belief belief = initial_belief(many);
  static std::uint64_t listed = 0;
  aos::progress::between = std::chrono::milliseconds{0};
  aos::progress::tell_to([](const char*, std::uint64_t done, std::uint64_t) { listed = std::max(listed, done); });
  Space little{aos::ListLimits{.work = states / 5}};
  EXPECT(!little.reach(belief));
  EXPECT_EQUAL(little.obstacle(), std::string{"there are too many outcomes to list"});
  EXPECT_EQUAL(listed, 0u);
  Space nearly{aos::ListLimits{.work = 2 * states / 3}};
  EXPECT(!nearly.reach(belief));
  EXPECT(listed > states / 4);
  aos::progress::tell_to(nullptr);
  aos::progress::between = std::chrono::milliseconds{250};
}

TEST("A later try is for half as many states in the belief, and lists fewer states than the first one") {
  Problem problem = corridor(30'000, 0.9);
  for (std::uint32_t cell = 0; cell < 30'000; ++cell) row(problem, cell, 1) = {{1.0, cell, 0, 0.0}};  // no way back
  TableModel::take(problem);
  const auto tries_from = [&](Space& space, aos::List<exam::Start> starts) {
    problem.starts = std::move(starts);
    return space.reach(initial_belief(problem));
  };
  Space first;
  EXPECT(tries_from(first, {{5'000, 1.0}}));
  Space space{aos::ListLimits{.states = 29'000}};
  EXPECT(!tries_from(space, {{0, 0.25}, {1, 0.25}, {2, 0.25}, {3, 0.25}}));
  EXPECT(!tries_from(space, {{12'000, 0.5}, {12'001, 0.25}, {12'002, 0.25}}));
  EXPECT(!tries_from(space, {{5'000, 0.5}, {5'001, 0.5}}));
  EXPECT(tries_from(space, {{15'000, 1.0}}));
  EXPECT_EQUAL(space.size(), 15'000u);
}

TEST("What so many decisions can lead to is listed without the states behind it") {
  const Problem problem = corridor(50, 0.9);
  const Belief belief = initial_belief(problem);
  Space space;
  space.reach_within(belief, 4);
  EXPECT_EQUAL(space.size(), 5u);
  EXPECT(!space.is_closed());
}

TEST("The running part of a belief comes by number, its weights as they are") {
  Problem problem = world(3, 1, 0.9);
  problem.endings[1] = 1;
  row(problem, 0, 0) = {{0.5, 1, 0, 0}, {0.3, 2, 0, 0}, {0.2, 0, 0, 0}};
  auto [belief, space] = Listed{problem};
  aos::Sampler random{1};
  belief = belief.predicted(0, random);
  EXPECT(space.reach(belief));
  double total = 0;
  std::uint32_t least = 0;
  for (const auto& [number, weight] : space.weights_of(belief)) {
    EXPECT(number >= least);
    least = number + 1;
    total += weight;
  }
  EXPECT_NEAR(total, 0.5, 1e-12);
}

TEST("Steps by the table have the odds of the model, and its expected rewards") {
  Problem problem = world(3, 1, 0.9);
  problem.endings[2] = 1;
  problem.sensings.push_back({{0, 0.3}, {1, 0.7}});
  row(problem, 0, 0) = {{0.1, 0, 0, 2.0}, {0.6, 1, 1, -1.0}, {0.3, 2, 0, 5.0}};
  auto [belief, space] = Listed{problem};
  aos::StepTable<TableModel> table;
  EXPECT(table.prepare(space, belief));
  aos::Sampler random{5};
  std::map<std::pair<int, aos::Observation>, int> counts;
  double rewards = 0;
  constexpr int draws = 100'000;
  for (int i = 0; i < draws; ++i) {
    const auto& outcome = table.outcome(table.start(random.bits()), 0, random.bits());
    const bool is_over = outcome.next == aos::StepTable<TableModel>::ended;
    ++counts[{is_over ? 2 : space[outcome.next].variables[0], is_over ? -1 : outcome.step.observation}];
    rewards += outcome.step.reward;
  }
  EXPECT_NEAR((counts[{0, -1}] / double{draws}), 0.1, 0.005);
  EXPECT_NEAR((counts[{1, 0}] / double{draws}), 0.18, 0.006);
  EXPECT_NEAR((counts[{1, 1}] / double{draws}), 0.42, 0.008);
  EXPECT_NEAR((counts[{2, -1}] / double{draws}), 0.3, 0.007);
  EXPECT_NEAR(rewards / draws, 0.1 * 2 - 0.6 + 0.3 * 5, 0.02);
}

TEST("Exact values are those that can be worked out by hand") {
  const Problem problem = tiger();
  auto [belief, space] = Listed{problem};
  const aos::ObservableValues observable{space.rows(), space.numbering(), 3};
  aos::ExactEvaluation evaluation{space.rows(), observable, {.beliefs = 1000}};
  const auto one = evaluation.action_values(space.exact_weights_of(belief), 1);
  EXPECT_NEAR(one[0].value, -1.0, 1e-12);
  EXPECT_NEAR(one[1].value, -45.0, 1e-12);
  const auto two = evaluation.action_values(space.exact_weights_of(belief), 2);
  EXPECT_NEAR(two[0].value, -1 - 0.95, 1e-12);
  EXPECT_NEAR(two[2].value, -45 - 0.95, 1e-12);
  // Listen twice; hear the same (0.745) and open the other door, or listen once more.
  const double same = 0.85 * 0.85 + 0.15 * 0.15;
  const double open = (0.85 * 0.85 * 10 - 0.15 * 0.15 * 100) / same;
  const auto three = evaluation.action_values(space.exact_weights_of(belief), 3);
  EXPECT_NEAR(three[0].value, -1 - 0.95 + 0.95 * 0.95 * (same * open - (1 - same)), 1e-12);
}

TEST("A belief that is a little wrong has values that may be wrong by what the largest rewards are worth") {
  const Problem problem = tiger();
  auto [belief, space] = Listed{problem};
  EXPECT_EQUAL(space.slack(belief, 3), 0);
  const Belief rough = Belief::of({belief.particles(), {}, {}}, 1e-7, false);
  EXPECT(rough.is_exact());
  EXPECT_NEAR(space.slack(rough, 2), 2e-7 * 100 * 1.95, 1e-15);
  EXPECT(!Belief::of({belief.particles(), {}, {}}, 1e-5, false).is_exact());
}

TEST("Exact values that exceed the budget are refused, and no wrong ones given") {
  const Problem problem = tiger();
  auto [belief, space] = Listed{problem};
  const aos::ObservableValues observable{space.rows(), space.numbering(), 10};
  aos::ExactEvaluation evaluation{space.rows(), observable, {.beliefs = 3}};
  bool is_refused = false;
  try {
    evaluation.action_values(space.exact_weights_of(belief), 10);
  } catch (const aos::NotEnumerable&) {
    is_refused = true;
  }
  EXPECT(is_refused);
}

}
