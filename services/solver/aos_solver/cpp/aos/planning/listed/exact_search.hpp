// The exact values of all actions over the whole horizon, if computing them fits the budget.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/backoff.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/planner.hpp"
#include "numbers/exact.hpp"
#include "numbers/observable_values.hpp"

namespace aos {

template <class Model>
class ExactSearch final : public Planner<Model> {
 public:
  explicit ExactSearch(const StateSpace<Model>& space) : Planner<Model>(space), space_(space) {}

  const char* name() const override { return "exact"; }

  // Bounds are prepared for a try, which takes long at the first decision only. A try that fails puts off the next ones.
  bool prepare(const Question<Model>& question, Sampler& /*random*/, Choosing& choosing) override {
    if (!switches::exact || !question.is_listed || space_.inexact_text(question.belief) != nullptr || !tries_.is_due()) return false;
    observable_.prepare(space_.rows(), space_.numbering(), question.horizon);
    const SearchTime time{choosing};
    const bool fits = evaluate(question.belief, question.budget, question.horizon);
    if (fits) choosing.why += ", and every observation of " +
                              std::to_string(question.horizon) + (question.horizon == 1 ? " decision" : " decisions") + " fits the budget";
    else choosing.simulations += simulations();
    return fits;
  }

  // Finds what missions lose that begin with the best action and plan anew at each step, which takes a quarter of the budget
  // at most.
  std::uint64_t search(const Question<Model>& question, Sampler& /*random*/, std::string& why) override {
    const auto action = static_cast<std::size_t>(best(question.barred));
    mean_loss_ = loss_error_ = 0;
    const auto losses = evaluation_->losses(space_.weights_of(question.belief), action, horizon_, limits_of(question.budget, horizon_));
    const auto count = static_cast<double>(losses.size());
    double squares = 0;
    for (const double loss : losses) mean_loss_ += loss / count;
    for (const double loss : losses) squares += (loss - mean_loss_) * (loss - mean_loss_);
    if (count > 1) loss_error_ = std::sqrt(squares / (count - 1) / count);
    if (const std::string unplayed = unplayed_text(losses.size()); !unplayed.empty()) why += "; the bounds are exact, and " + unplayed;
    loss_error_ = std::hypot(loss_error_, error_of_unplayed(count, std::abs(values_[action].value)));
    const std::uint64_t taken = simulations();
    evaluation_.reset();
    return taken;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override {
    Estimates estimates;
    for (const ExactValue& value : values_) estimates.push_back({value.value, 1, 0, 0, value.value - error_, value.value + error_});
    return estimates;
  }
  int choice(const Estimates& /*estimates*/, int /*horizon*/, const BarredActions& barred) const override { return best(barred); }
  // What missions return that plan anew at each step. Bounds are those of the best way of deciding.
  Estimates values(const Belief<Model>& /*belief*/, Estimates estimates, int /*choice*/) const override {
    for (ActionEstimate& estimate : estimates) {
      estimate.q -= mean_loss_;
      estimate.standard_error = loss_error_;
    }
    return estimates;
  }
  void start_over() override { tries_ = Backoff{1}; }

 private:
  static constexpr double share_of_budget = 0.25;
  static constexpr std::uint64_t max_beliefs = 1'000'000;

  // Tries to compute the values with a share of the budget.
  bool evaluate(const Belief<Model>& belief, Budget budget, int horizon) {
    evaluation_.emplace(space_.rows(), observable_, limits_of(budget, horizon));
    horizon_ = horizon;
    try {
      values_ = evaluation_->action_values(space_.weights_of(belief), horizon);
      error_ = evaluation_->error(horizon);
      tries_.succeed();
      return true;
    } catch (const NotEnumerable&) {
      tries_.fail();
      return false;
    }
  }

  // How many simulations the last try has taken so far.
  std::uint64_t simulations() const { return Budget::simulations_of(evaluation_->work(), horizon_); }
  int best(const BarredActions& barred) const {
    return static_cast<int>(soonest_of_best(values_, [&](std::size_t action) { return barred.contains(action); }));
  }

  static ExactLimits limits_of(Budget budget, int horizon) {
    ExactLimits limits{.beliefs = max_beliefs};
    if (budget.simulations > 0) {
      limits.work = static_cast<Operations>(share_of_budget * static_cast<double>(budget.operations(horizon))) + 1;
    }
    if (budget.seconds > 0) {
      limits.is_over = [start = PlanningClock::now(), seconds = share_of_budget * budget.seconds] { return seconds_since(start) >= seconds; };
    }
    return limits;
  }

  const StateSpace<Model>& space_;
  ObservableValues observable_;
  List<ExactValue> values_;  // by action
  double error_ = 0;                // of the values, at most
  double mean_loss_ = 0;
  double loss_error_ = 0;
  std::optional<ExactEvaluation> evaluation_;  // between `prepare` and `search`
  int horizon_ = 1;
  Backoff tries_{1};
};

}
