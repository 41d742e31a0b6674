// Ways to rewards that ask for many conditions at once: option_search.hpp.
#include "aos/planning/options/option_search.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace units::option_search_tests {

constexpr std::size_t dials = 5;
constexpr std::uint32_t digits = 4;
constexpr std::uint32_t right = 2;

// A lock that opens when all dials are right. It says how many are, if it says anything.
// Action d turns dial d on by one, and the last action pulls.
Problem lock(bool says_how_many) {
  std::uint32_t states = 1;
  for (std::size_t dial = 0; dial < dials; ++dial) states *= digits;
  Problem problem = world(states + 1, dials + 1, 0.95);
  problem.horizon = 60;
  problem.variables = dials;
  problem.values.assign((states + 1) * dials, static_cast<int>(digits));
  problem.endings[states] = 1;
  for (std::uint32_t state = 0; state < states; ++state) {
    std::uint32_t place = 1;
    std::size_t met = 0;
    for (std::size_t dial = 0; dial < dials; ++dial, place *= digits) {
      const std::uint32_t digit = state / place % digits;
      problem.values[state * dials + dial] = static_cast<int>(digit);
      met += digit == right ? 1 : 0;
      const std::uint32_t turned = state - digit * place + (digit + 1) % digits * place;
      row(problem, state, dial) = {{1.0, turned, 0, -0.1}};
    }
    const bool is_right = met == dials;
    if (says_how_many) problem.conditions.push_back(static_cast<int>(met));
    row(problem, state, dials) = {{1.0, is_right ? states : state, 0, is_right ? 50.0 : -1.0}};
  }
  if (says_how_many) problem.conditions.push_back(0);  // of the end
  return problem;
}

aos::List<aos::Option> ways(const Problem& problem, double& steps) {
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  aos::LeafCells<TableModel> cells;
  cells.prepare(belief, random);
  const aos::DecisionClock clock;
  aos::RunningDown<TableModel> running_down;
  running_down.find(belief, random);
  aos::OptionSearch<TableModel> search{cells, clock, &running_down, TableModel::has_goal_conditions};
  return search.from(belief.particles().front().state, steps, random);
}

TEST("A way to a reward that asks for five conditions is found by how many of them hold") {
  const Problem problem = lock(true);
  double steps = 20'000;
  const auto found = ways(problem, steps);
  EXPECT(!found.empty());
  if (!found.empty()) EXPECT_EQUAL(found.front().size(), right * dials + 1);
  EXPECT(steps > 18'000);
}

TEST("No new value and no new pair of values leads to a reward that asks for five conditions") {
  const Problem problem = lock(false);
  double steps = 20'000;
  EXPECT(ways(problem, steps).empty());
}

TEST("An exit that earns nothing ends no search for what pays, and a search heeds what no walk has changed") {
  double steps = 20'000;
  const Problem problem = corridor_with_exits(6, 3);
  const auto found = ways(problem, steps);
  EXPECT((!found.empty() && found.front() == aos::Option(6, 3)));
  aos::Sampler random{1};
  aos::LeafCells<TableModel> cells;
  cells.prepare(Belief::initial(random), random);
  EXPECT_EQUAL(cells.with_resting().size(), cells.size() + 1);
}

}
