// Rollouts at random: rollout.hpp.
#include "aos/model/rollout.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace {

using units::TableModel;

TEST("Rollouts at random reach the end of a corridor, which takes twelve equal actions") {
  const units::Problem problem = units::corridor(12, 1);
  TableModel::take(problem);
  TableModel::State start{};
  aos::Sampler random{1};
  TableModel::initial(start, random);
  double sum = 0;
  for (int i = 0; i < 2000; ++i) sum += TableModel::rollout(start, 24, random);
  EXPECT(sum / 2000 > 1.5);
}

}  // namespace
