// What a planner may spend on a decision, and its estimates of the actions.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include "aos/base/list.hpp"
#include "aos/base/switches.hpp"

namespace aos {

inline constexpr std::uint32_t no_node = 0xffffffffu;
inline constexpr int max_search_threads = 32;

// Work is counted in operations. An operation is about one multiplication with its look-ups in memory, a nanosecond or so.
// It is counted and not timed, so that the same seed gives the same decision on every machine.
using Operations = std::uint64_t;

inline constexpr Operations operations_of_step = 100;  // of the model, with what a search does for it
inline constexpr double operations_of_second = 1e9;

// A simulation is the work of a path from the belief of `horizon` steps of the model, in all planners. Where POMCP values
// new histories by rollouts, it is one descent with its rollout.
struct Budget {
  std::uint64_t simulations = 0;  // 0: no limit
  double seconds = 0;             // 0: no limit
  int threads = 1;                // 1 to `max_search_threads`

  // So large a share of it.
  Budget part(double share) const {
    const double part = std::ceil(share * simulations);
    return {static_cast<std::uint64_t>(part), share * seconds, threads};
  }
  // What is left of it after so many seconds: a tenth at least, so that nobody decides without a search.
  Budget left_after(double spent_s) const {
    constexpr double least_left = 0.1;
    return {simulations, seconds > 0 ? std::max(seconds - spent_s, least_left * seconds) : 0, threads};
  }
  Operations operations(int horizon) const { return simulations * operations_of_simulation(horizon); }
  static Operations operations_of_simulation(int horizon) {
    return operations_of_step * static_cast<Operations>(horizon > 0 ? horizon : 1);
  }
  // What may be worked in all, also within a budget in time.
  double work(int horizon) const {
    return simulations > 0 ? static_cast<double>(operations(horizon)) : seconds * operations_of_second;
  }
  // How many simulations were begun by so much work.
  static std::uint64_t simulations_of(Operations work, int horizon) {
    const Operations each = operations_of_simulation(horizon);
    return (work + each - 1) / each;
  }
};

// Actions that a decision may not take, since they cannot be carried out now. Later decisions may take them.
using BarredActions = std::set<std::size_t>;

// An action's value, its simulations (0: unknown), the standard error of the value, the immediate reward, and between
// which proven bounds the value is; infinite ones are unknown. What the value is, a planner says; see action_values.hpp.
struct ActionEstimate {
  double q = 0;
  std::uint32_t n = 0;
  double standard_error = 0;
  double reward = 0;
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};
using Estimates = List<ActionEstimate>;  // by action

// The action with the highest value of those that count, or, of actions that are as good, the one with the highest immediate
// reward: what is as good later would else be put off for ever, since the best of many later choices is estimated too high. As
// good is a value that is less by at most sqrt(2 ln horizon) errors, by which the best of `horizon` values of the same error
// exceeds their mean, and by at most what a delay by one of `horizon` steps can be worth.
int preferred_action(const Estimates& estimates, int horizon, auto&& counts) {
  const ActionEstimate* best = nullptr;
  for (const ActionEstimate& estimate : estimates) {
    if (counts(estimate) && (best == nullptr || estimate.q > best->q)) best = &estimate;
  }
  if (best == nullptr) return 0;
  if (!switches::sooner) return static_cast<int>(best - estimates.data());
  const ActionEstimate* soonest = best;
  for (const ActionEstimate& estimate : estimates) {
    if (!counts(estimate) || estimate.reward <= soonest->reward) continue;
    const double error = std::hypot(estimate.standard_error, best->standard_error) * std::sqrt(2 * std::log(horizon));
    if (best->q - estimate.q <= std::fmin(error, std::abs(best->q) / horizon)) soonest = &estimate;
  }
  return static_cast<int>(soonest - estimates.data());
}

}
