// Expected rewards and which values are reliable: few_outcomes.hpp and exploration.hpp.
#include "aos/planning/values/few_outcomes.hpp"

#include "aos/planning/pomcp/exploration.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::expected_rewards_tests {

TEST("A reward counts by its expectation, a loss of one in 10,000 in full") {
  Problem problem = world(1, 1, 1);
  row(problem, 0, 0) = {{0.9999, 0, 0, 1}, {0.0001, 0, 0, -100'000}};
  aos::ExpectedRewards<TableModel> rewards;
  EXPECT_NEAR(rewards.of(first_state(problem), 0).value_or(0), 0.9999 - 10, 1e-9);
}

TEST("Rewards of a step with many outcomes are left to chance, those of other actions are not") {
  Problem problem = world(1, 2, 1);
  row(problem, 0, 0) = {};
  for (int i = 0; i < 100; ++i) row(problem, 0, 0).push_back({0.01, 0, 0, static_cast<double>(i)});
  row(problem, 0, 1) = {{1.0, 0, 0, 5}};
  const TableModel::State state = first_state(problem);
  aos::ExpectedRewards<TableModel> rewards;
  EXPECT(!rewards.of(state, 0).has_value());
  EXPECT_EQUAL(rewards.of(state, 1).value_or(0), 5);
}

TEST("A certain value is reliable after few visits, and an uncertain one is not") {
  const aos::ActionEstimate most{.q = -0.3, .n = 4000, .standard_error = 0.1};
  EXPECT(aos::is_certain({.q = -0.1, .n = 100, .standard_error = 0}, most));
  EXPECT(!aos::is_certain({.q = -0.1, .n = 100, .standard_error = 0.5}, most));
  EXPECT(!aos::is_certain({.q = -0.1, .n = 3, .standard_error = 0}, most));
}

}
