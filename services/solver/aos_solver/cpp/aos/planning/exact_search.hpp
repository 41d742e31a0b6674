// The exact values of all actions over the whole horizon, if computing them fits the budget.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/exact.hpp"
#include "aos/planning/state_space.hpp"

namespace aos {

template <class Model>
class ExactSearch {
 public:
  explicit ExactSearch(const StateSpace<Model>& space) : space_(space) {}

  // Whether this decision makes a try. If so, bounds are prepared for it, which takes long at the first decision only.
  bool prepare(int horizon) {
    if (put_off_ > 0) {
      --put_off_;
      return false;
    }
    observable_.prepare(space_, horizon);
    return true;
  }

  // Tries to compute the values with a share of the budget. A failure returns false and puts off the next tries.
  bool search(const Belief<Model>& belief, Budget budget, int horizon) {
    evaluation_.emplace(space_, observable_, limits_of(budget, horizon));
    budget_ = budget;
    horizon_ = horizon;
    try {
      values_ = evaluation_->action_values(belief, horizon);
      error_ = evaluation_->error(horizon);
      failures_ = 0;
      return true;
    } catch (const NotEnumerable&) {
      put_off_ = failures_ < max_failures ? (1 << failures_++) - 1 : 1 << max_failures;
      return false;
    }
  }

  // Finds what missions lose that begin with an action and plan anew at each step, which takes a quarter of the budget at
  // most. Returns how many simulations everything counts as.
  std::uint64_t play(const Belief<Model>& belief, int action) {
    mean_loss_ = loss_error_ = 0;
    const auto losses = evaluation_->losses(belief, static_cast<std::size_t>(action), horizon_, limits_of(budget_, horizon_));
    const auto count = static_cast<double>(losses.size());
    double squares = 0;
    for (const double loss : losses) mean_loss_ += loss / count;
    for (const double loss : losses) squares += (loss - mean_loss_) * (loss - mean_loss_);
    if (count > 1) loss_error_ = std::sqrt(squares / (count - 1) / count);
    loss_error_ = std::hypot(loss_error_, error_of_unplayed(count, std::abs(values_[static_cast<std::size_t>(action)].value)));
    const std::uint64_t taken = simulations();
    evaluation_.reset();
    return taken;
  }
  // What missions return that plan anew at each step. Bounds are those of the best way of deciding.
  std::vector<ActionEstimate> values() const {
    std::vector<ActionEstimate> result = estimates();
    for (ActionEstimate& estimate : result) {
      estimate.q -= mean_loss_;
      estimate.standard_error = loss_error_;
    }
    return result;
  }
  // How many simulations the last try has taken so far.
  std::uint64_t simulations() const { return Budget::simulations_of(evaluation_->work(), horizon_); }
  std::vector<ActionEstimate> estimates() const {
    std::vector<ActionEstimate> estimates;
    for (const ExactValue& value : values_) estimates.push_back({value.value, 1, 0, 0, value.value - error_, value.value + error_});
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
      limits.work = static_cast<Operations>(share_of_budget * static_cast<double>(budget.operations(horizon))) + 1;
    }
    if (budget.seconds > 0) {
      limits.is_over = [start = PlanningClock::now(), seconds = share_of_budget * budget.seconds] {
        return std::chrono::duration<double>(PlanningClock::now() - start).count() >= seconds;
      };
    }
    return limits;
  }

  const StateSpace<Model>& space_;
  ObservableValues<Model> observable_;
  std::vector<ExactValue> values_;  // by action
  double error_ = 0;                // of the values, at most
  double mean_loss_ = 0;
  double loss_error_ = 0;
  std::optional<ExactEvaluation<Model>> evaluation_;  // between `search` and `play`
  Budget budget_;
  int horizon_ = 1;
  int put_off_ = 0;  // how many decisions make no try
  int failures_ = 0;
};

}  // namespace aos
