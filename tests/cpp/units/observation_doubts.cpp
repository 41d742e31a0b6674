// What observations tell of the state, by the visits of a search tree: observation_doubts.hpp.
#include "aos/planning/pomcp/observation_doubts.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace units::observation_doubts_tests {

// A tree whose root has one action, after which each observation came so often. The rest of its 100 visits has ended.
double told(const aos::List<std::uint32_t>& visits, double doubt_of_visit) {
  aos::SearchTree tree{1, std::size_t{1} << 20};
  tree.give_actions(0);
  const std::uint32_t action = tree.history(0).first_action;
  tree.action(action).n = 100;
  aos::Observation seen = 0;
  for (const std::uint32_t n : visits) tree.history(tree.add_child(action, seen++)).n = n;
  return aos::information_of(tree, tree.action(action), 100 * doubt_of_visit);
}

TEST("An observation that is certain in each state tells its whole entropy, and one that is noise tells nothing") {
  EXPECT_NEAR(told({50, 50}, 0), std::log(2), 1e-12);
  EXPECT_NEAR(told({50, 50}, std::log(2)), 0, 1e-12);
  EXPECT_NEAR(told({49, 51}, std::log(2)), 0, 1e-12);
  EXPECT_NEAR(told({100}, 0), 0, 1e-12);
}

TEST("That a mission goes on tells something, too") { EXPECT_NEAR(told({50}, 0), std::log(2), 1e-12); }

TEST("What a known state leaves open is the entropy of its observations, and an end is one of them") {
  Problem problem = world(2, 3, 0.9);
  problem.endings[1] = 1;
  row(problem, 0, 0) = {{0.5, 0, 0, 1.0}, {0.5, 0, 0, -1.0}};
  problem.sensings.push_back({{0, 0.25}, {1, 0.75}});
  row(problem, 0, 1) = {{1.0, 0, 1, 0.0}};
  row(problem, 0, 2) = {{0.5, 0, 0, 0.0}, {0.5, 1, 0, 0.0}};
  const TableModel::State state = first_state(problem);
  aos::ObservationDoubts<TableModel> doubts;
  EXPECT_NEAR(doubts.of(state, 0).value(), 0, 1e-12);
  EXPECT_NEAR(doubts.of(state, 1).value(), 0.25 * std::log(4) + 0.75 * std::log(4.0 / 3), 1e-12);
  EXPECT_NEAR(doubts.of(state, 2).value(), std::log(2), 1e-12);
}

}
