// Rollouts at random: rollout.hpp.
#include "aos/model/rollout.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace units::rollout_tests {

double mean_return(const Problem& problem, int horizon) {
  constexpr int rollouts = 2000;
  const TableModel::State start = first_state(problem);
  aos::Sampler random{1};
  double sum = 0;
  for (int i = 0; i < rollouts; ++i) {
    int left = horizon;
    sum += TableModel::rollout(start, left, random);
  }
  return sum / rollouts;
}

TEST("Rollouts at random reach the end of a corridor, which takes twelve equal actions") {
  EXPECT(mean_return(corridor(12, 1), 24) > 1.5);
}

TEST("Rollouts at random get past an exit that is open everywhere and earns nothing") {
  EXPECT(mean_return(corridor_with_exits(20, 1), 40) > 0.5);
}

}
