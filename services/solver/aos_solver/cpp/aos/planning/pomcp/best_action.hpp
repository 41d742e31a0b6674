// The best action of a history, whose value is the value of the history (Coulom, 2006): the mean of all simulations is pulled
// down by those that explore. Only actions with enough visits for a reliable value count, in the decision at the root, too.
#pragma once

#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/pomcp/search_tree.hpp"

namespace aos {

// Whether an action has enough visits, beside the most visited one, for its value to be reliable.
inline bool is_well_visited(std::uint32_t n, std::uint32_t max_visits) {
  return static_cast<std::uint64_t>(n) * well_visited_share >= max_visits && n > 0;
}

// Makes action `a` the best one if its value is reliable, and higher or more reliable than that of the best so far.
[[gnu::always_inline]] inline void take_better(HistoryNode& history, const ActionNode* actions, std::uint32_t a) {
  if (!is_well_visited(actions[a].n, history.max_visits)) return;
  const ActionNode& best = actions[history.best];
  if (!is_well_visited(best.n, history.max_visits) || actions[a].q > best.q) history.best = a;
}

[[gnu::always_inline]] inline void renew_best(HistoryNode& history, const ActionNode* actions, std::uint32_t count,
                                              std::uint32_t visited, bool has_fallen) {
  const bool is_best = visited == history.best;
  if ((is_best && has_fallen) || !is_well_visited(actions[history.best].n, history.max_visits)) {
    history.best = visited;
    for (std::uint32_t a = 0; a < count; ++a) take_better(history, actions, a);
  } else if (!is_best) {
    take_better(history, actions, visited);
  }
}

}
