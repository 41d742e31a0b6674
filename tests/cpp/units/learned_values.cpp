// Values of states that are learned from simulations: learned_values.hpp.
#include "aos/planning/learned_values.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace learned_values_tests {

using units::TableModel;
using Belief = aos::Belief<TableModel>;

constexpr int horizon = 60;

TEST("Values are learned behind an exit that is open everywhere") {
  const units::Problem problem = units::corridor_with_exits(40, 3);
  TableModel::take(problem);
  aos::Sampler random{1};
  const Belief belief = Belief::initial(random);
  aos::LearnedValues<TableModel> values;
  EXPECT(values.prepare(belief, horizon, random));
  const TableModel::State& start = belief.particles().front().state;
  EXPECT_NEAR(values.value(start, horizon), 10, 0.5);
  double worths[4] = {};
  values.advantages(start, worths, random);
  EXPECT_NEAR(worths[0], -10, 0.5);
  EXPECT_NEAR(worths[3], 0, 0.5);
}

}  // namespace learned_values_tests
