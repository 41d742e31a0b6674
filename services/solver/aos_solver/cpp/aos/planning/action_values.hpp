// What a decision tells of its actions: estimates of the discounted return of the next `horizon` decisions, beginning with
// the action, with honest standard errors (docs/planning.md).
//
// A search decides by a lower bound, or by guesses where it ended, and the mission plans anew at each step, and finds more. Three
// rules turn the one into the other: `set_between` for proven bounds, `values_of_promise` for trees that end in values of seen
// states, which promise too much, and `values_of_tree` for trees that end in rollouts, which guess too low.
#pragma once

#include <string>

#include "aos/planning/budget.hpp"

namespace aos {

// What a search has gained at the root over the guess of its leaves, and for each action the discounted probability
// that a mission that follows the tree comes to a leaf, unless it ends before.
struct TreeReach {
  double gain = 0;
  List<double> beyond;
};

// What a tree promises of the action that was chosen, and what missions return that are played from its belief, with the
// standard error of that.
struct Promise {
  double most = 0;
  double played = 0;
  double played_error = 0;
  bool is_guess = false;  // whether the value is what the missions return
};

// The values of actions whose estimates come from a tree that ends in values of seen states.
inline Estimates values_of_promise(Estimates estimates, const Promise& promise, int choice) {
  const double chosen = estimates[choice].q;
  const double reach = std::max(std::abs(promise.most - chosen), std::abs(promise.played - chosen)) / 2;
  const double moved = promise.is_guess ? promise.played - chosen : 0;
  for (ActionEstimate& estimate : estimates) {
    if (estimate.n == 0) continue;
    estimate.q = std::min(estimate.q + moved, estimate.at_most);
    estimate.standard_error = std::hypot(estimate.standard_error, reach, promise.played_error);
  }
  return estimates;
}

// The values of actions whose estimates come from a tree that ends in rollouts.
inline Estimates values_of_tree(Estimates estimates, const TreeReach& reach, int choice) {
  const double moved = reach.gain * reach.beyond[choice] / 2;
  for (std::size_t a = 0; a < estimates.size(); ++a) {
    ActionEstimate& estimate = estimates[a];
    if (estimate.n == 0) continue;
    estimate.q = std::min(estimate.q + moved, estimate.at_most);
    estimate.standard_error = std::hypot(estimate.standard_error, reach.gain * reach.beyond[a] / 2);
  }
  return estimates;
}

// The error of a mean loss where fewer missions than `missions_that_tell` were played. Nothing is known of the others: by
// Laplace's rule of succession one in `played + 2` of them loses `most`. So one mission without a loss is no proof.
inline constexpr double missions_that_tell = 30;
inline double error_of_unplayed(double played, double most) {
  return std::max(1 - played / missions_that_tell, 0.0) * std::max(most, 0.0) / (played + 2);
}

// What the error of a value rests on, where fewer missions than these were played.
inline std::string unplayed_text(std::size_t played) {
  if (played >= missions_that_tell) return {};
  return "the error is that of " + std::to_string(played) + " of 30 missions that plan anew";
}

// The values of actions with bounds; `lowers` and `uppers` are between what the values may be, proven or not.
inline void set_between(Estimates& estimates, const List<double>& lowers,
                        const List<double>& uppers, int choice) {
  static const double deviation_of_even = 1 / std::sqrt(12.0);
  const std::size_t chosen = choice;
  const double most = (lowers[chosen] + uppers[chosen]) / 2;
  for (std::size_t a = 0; a < estimates.size(); ++a) {
    // The decision is by the lower bounds, and no action is told to be worth more than the one that was chosen.
    estimates[a].q = std::min((lowers[a] + uppers[a]) / 2, most);
    estimates[a].standard_error = (uppers[a] - lowers[a]) * deviation_of_even;
  }
}

}
