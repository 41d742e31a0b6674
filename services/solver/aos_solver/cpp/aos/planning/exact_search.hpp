// The exact values of all actions over the whole horizon, if computing them fits the budget.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/exact.hpp"
#include "aos/planning/state_space.hpp"

namespace aos {

template <class Model>
class ExactSearch {
 public:
  explicit ExactSearch(const StateSpace<Model>& space) : space_(space) {}

  // Tries to compute the values with a share of the budget. A failure returns false and puts off the next tries.
  bool search(const Belief<Model>& belief, Budget budget, int horizon) {
    if (put_off_ > 0) {
      --put_off_;
      return false;
    }
    ExactEvaluation<Model> evaluation{space_, limits_of(budget, horizon)};
    try {
      values_ = evaluation.action_values(belief, horizon);
      simulations_ = evaluation.outcomes() / static_cast<std::uint64_t>(horizon) + 1;
      failures_ = 0;
      return true;
    } catch (const NotEnumerable&) {
      put_off_ = failures_ < max_failures ? (1 << failures_++) - 1 : 1 << max_failures;
      return false;
    }
  }

  std::uint64_t simulations() const { return simulations_; }
  std::vector<ActionEstimate> estimates() const {
    std::vector<ActionEstimate> estimates;
    for (const ExactValue& value : values_) estimates.push_back({value.value, 1, 0});
    return estimates;
  }
  int best(const BarredActions& barred) const {
    const ExactValue* best = nullptr;
    for (const ExactValue& value : values_) {
      if (barred.contains(static_cast<std::size_t>(&value - values_.data()))) continue;
      if (best == nullptr || value.is_better_than(*best)) best = &value;
    }
    return best == nullptr ? 0 : static_cast<int>(best - values_.data());
  }
  // Begins another mission, whose tries do not depend on those of earlier ones.
  void start_over() { put_off_ = failures_ = 0; }

 private:
  static constexpr double share_of_budget = 0.25;
  static constexpr std::uint64_t max_beliefs = 1'000'000;
  static constexpr int max_failures = 4;

  static ExactLimits limits_of(Budget budget, int horizon) {
    ExactLimits limits{.beliefs = max_beliefs};
    if (budget.simulations > 0) {
      const double outcomes = share_of_budget * static_cast<double>(budget.simulations) * horizon;
      limits.outcomes = static_cast<std::uint64_t>(outcomes) + 1;
    }
    if (budget.seconds > 0) {
      limits.is_over = [start = PlanningClock::now(), seconds = share_of_budget * budget.seconds] {
        return std::chrono::duration<double>(PlanningClock::now() - start).count() >= seconds;
      };
    }
    return limits;
  }

  const StateSpace<Model>& space_;
  std::vector<ExactValue> values_;  // by action
  std::uint64_t simulations_ = 0;
  int put_off_ = 0;  // how many decisions make no try
  int failures_ = 0;
};

}  // namespace aos
