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

TEST("Rollouts at random get past an exit that is open everywhere and earns nothing") {
  const units::Problem problem = units::corridor_with_exits(20, 1);
  TableModel::take(problem);
  TableModel::State start{};
  aos::Sampler random{2};
  TableModel::initial(start, random);
  double sum = 0;
  for (int i = 0; i < 2000; ++i) sum += TableModel::rollout(start, 40, random);
  EXPECT(sum / 2000 > 0.5);
}

}  // namespace
