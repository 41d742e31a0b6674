// The index compares ways by what they save soon, as if the robot did not plan later. So the best ways are compared by
// missions that go by the index later (rollouts: Bertsekas and Castanon, 1999).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/planning/option_search.hpp"
#include "aos/planning/rest_values.hpp"
#include "aos/planning/sampled_belief.hpp"
#include "aos/planning/saving_index.hpp"

namespace aos {

// A way, and how much more it returns than the first one.
struct BetterWay {
  std::size_t way = 0;
  double gain = 0;
};

// The way whose missions return more than those of the first one by most standard errors above `beyond_doubt`; the first
// one where there is none. Missions are played while there are steps, in the same states and under the same luck.
template <class Model>
BetterWay way_beyond_doubt(const SavingIndex<Model>& index, const SampledBelief<Model>& belief, const std::vector<Option>& ways, int horizon,
                           double& steps, Sampler& random) {
  constexpr int fewest = 16;  // missions of each way
  constexpr double beyond_doubt = 2;
  std::vector<double> sums(ways.size(), 0);
  std::vector<double> squares(ways.size(), 0);
  const double before = steps;
  int count = 0;
  for (; steps > 0 && (count == 0 || steps > (before - steps) / count); ++count) {
    const StepLuck luck{random};
    draw_states(belief.weights(), 1, random, [&](std::size_t k) {
      const double first = index.returned(ways.front(), belief.states()[k], horizon, luck, steps);
      for (std::size_t i = 1; i < ways.size(); ++i) {
        const double more = index.returned(ways[i], belief.states()[k], horizon, luck, steps) - first;
        sums[i] += more;
        squares[i] += more * more;
      }
    });
  }
  BetterWay better;
  if (count < fewest) return better;
  double most = 0;
  for (std::size_t i = 1; i < ways.size(); ++i) {
    const double mean = sums[i] / count;
    const double error = std::sqrt(std::max(squares[i] / count - mean * mean, 0.0) / (count - 1));
    if (mean - beyond_doubt * error <= most) continue;
    most = mean - beyond_doubt * error;
    better = {i, mean};
  }
  return better;
}

}  // namespace aos
