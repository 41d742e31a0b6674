// How much a search explores: the bonus of an action in its upper confidence bound. It follows the spread of the action's own
// returns, and is polynomial and not logarithmic, since values drift while the tree below them grows (Shah, Xie and Xu, 2020).
#pragma once

#include "aos/base/switches.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/pomcp/search_tree.hpp"

namespace aos {

// The bonuses of one history's actions. The spread of an action is that of its own returns and of `prior_visits`
// returns with the history's spread. The history's spread is filled up with the root's in the same way.
class ExplorationBonus {
 public:
  [[gnu::always_inline]] ExplorationBonus(const HistoryNode& history, double root_spread)
      : root_n_(std::sqrt(static_cast<double>(history.n) + 1)),
        prior_(prior_visits * (history.squares + prior_visits * root_spread) / (history.n + prior_visits)) {}

  [[gnu::always_inline]] double of(const ActionNode& action) const {
    const double n = std::max<double>(action.n, 1);
    if (!switches::own_spread) return std::sqrt(prior_ / prior_visits * action.share * root_n_ / n);
    const double squares = (action.squares + prior_) * action.share;
    return std::sqrt(squares * root_n_ / ((n + prior_visits) * n));
  }

 private:
  double root_n_;
  double prior_;
};

// Whether an action's value is as reliable as that of the most visited action would be with a quarter of its visits.
// A search seldom tries an action whose outcome is certain, and that is enough. The action's spread is filled up with
// that of the most visited one, since few visits may have missed what is rare.
inline bool is_certain(const ActionEstimate& estimate, const ActionEstimate& most) {
  const auto variance = [](const ActionEstimate& of) { return of.n * of.standard_error * of.standard_error; };
  const double n = estimate.n;
  const double spread = (n * variance(estimate) + prior_visits * variance(most)) / (n + prior_visits);
  return spread / n <= well_visited_share * variance(most) / most.n;
}

// The variance of the best root action's returns, or of all returns while that is unknown.
class RootSpread {
 public:
  // Begins a simulation.
  void count(const ActionNode& best) {
    if (++simulations_ % spread_renewal != 0 && simulations_ != settled_visits) return;
    variance_ = best.n >= settled_visits ? best.squares / best.n : squares_ / simulations_;
  }
  // Ends a simulation by its return.
  void add(double seen) {
    const double deviation = seen - mean_;
    mean_ += deviation / simulations_;
    squares_ += deviation * (seen - mean_);
  }
  std::uint64_t simulations() const { return simulations_; }
  double variance() const { return variance_; }

 private:
  std::uint64_t simulations_ = 0;
  double mean_ = 0;     // of all returns
  double squares_ = 0;  // sum of the returns' squared deviations from their mean
  double variance_ = 0;
};

// If rollouts value new histories, the actions that a rollout would take get most of the exploration. The
// other actions must not use up the few visits of a history. POMCP's paper begins with visits and values of
// actions, which the document's author would have to know.
inline void share_exploration(ActionNode* actions, const List<double>& rollout_odds) {
  const auto count = static_cast<double>(rollout_odds.size());
  for (std::size_t a = 0; a < rollout_odds.size(); ++a) {
    actions[a].share = even_share + (1 - even_share) * rollout_odds[a] * count;
  }
}

}
