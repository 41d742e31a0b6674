// Values of a search drawn towards a prior, as far as the search does not show that the prior is wrong: empirical Bayes
// (Efron and Morris, 1973).
//
// With many actions and few simulations the best of many noisy values is rarely the best action, while the prior, which
// ranks them by what is learned of states, has no noise. How wrong the prior is shows in how far the values are from it
// beyond what their errors explain; no farther than that they count.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/planning/budget.hpp"

namespace aos {

// `prior` is how much less each action is worth than the best one, in the unit of the estimates. `counts(estimate)` tells
// whose value was searched for long enough; the others are given the prior's.
template <class Counts>
void draw_towards(const std::vector<double>& prior, std::vector<ActionEstimate>& estimates, Counts&& counts) {
  double sum = 0;
  double count = 0;
  for (std::size_t a = 0; a < prior.size(); ++a) {
    if (!counts(estimates[a])) continue;
    sum += estimates[a].q + prior[a];
    ++count;
  }
  if (count == 0) return;
  const double level = sum / count;  // of the best action, by the prior
  double unexplained = 0;
  for (std::size_t a = 0; a < prior.size(); ++a) {
    const double distance = estimates[a].q - (level - prior[a]);
    if (counts(estimates[a])) unexplained += distance * distance - estimates[a].standard_error * estimates[a].standard_error;
  }
  const double spread = std::max(unexplained / std::max(count - 1, 1.0), 0.0);  // variance of the prior's errors
  for (std::size_t a = 0; a < prior.size(); ++a) {
    const double error = estimates[a].standard_error * estimates[a].standard_error;
    const double share = counts(estimates[a]) && spread > 0 ? spread / (spread + error) : 0;
    estimates[a].q = share * estimates[a].q + (1 - share) * (level - prior[a]);
  }
}

}  // namespace aos
