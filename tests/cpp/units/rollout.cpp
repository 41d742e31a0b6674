// Rollouts at random: rollout.hpp.
#include "aos/model/rollout.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace rollout_tests {

using units::TableModel;

double mean_return(const units::Problem& problem, int horizon) {
  constexpr int rollouts = 2000;
  TableModel::take(problem);
  TableModel::State start{};
  aos::Sampler random{1};
  TableModel::initial(start, random);
  double sum = 0;
  for (int i = 0; i < rollouts; ++i) {
    int left = horizon;
    sum += TableModel::rollout(start, left, random);
  }
  return sum / rollouts;
}

TEST("Rollouts at random reach the end of a corridor, which takes twelve equal actions") {
  EXPECT(mean_return(units::corridor(12, 1), 24) > 1.5);
}

TEST("Rollouts at random get past an exit that is open everywhere and earns nothing") {
  EXPECT(mean_return(units::corridor_with_exits(20, 1), 40) > 0.5);
}

}
