// Exact finite-horizon values of a listed model, by enumerating every observation of every action. Searches are measured
// against these values, and a planner uses them if they fit the budget.
//
// A belief is a sorted list of (state number, weight) without its ended part, which is worth nothing. Equal
// beliefs at equal depth are evaluated once. Below the root, an action is left out if its fully observable
// value is no higher than the value of another action. Of two actions with the same value, the one that earns
// sooner is better: otherwise a free exit could be put off for ever.
#pragma once

#include <functional>
#include <map>
#include <unordered_map>

#include "aos/base/function_ref.hpp"
#include "aos/draws/random.hpp"
#include "numbers/belief_key.hpp"
#include "numbers/observable_values.hpp"
#include "point_based/flat_model.hpp"

namespace aos {

// The limits of an evaluation: distinct beliefs, operations (0: no limit; budget.hpp), and `is_over`.
struct ExactLimits {
  std::uint64_t beliefs = 0;
  std::uint64_t work = 0;
  std::function<bool()> is_over = [] { return false; };
};

// The value of an action or a belief, and its derivative by the discount, which is smaller if rewards come sooner.
struct ExactValue {
  double value = 0;
  double growth = 0;

  // Whether this value is higher than another one, or as high and earned sooner.
  bool is_better_than(const ExactValue& other) const {
    const double tie = rounding * (std::abs(value) + std::abs(other.value));
    return value > other.value + tie || (value >= other.value - tie && is_sooner_than(other));
  }
  bool is_sooner_than(const ExactValue& other) const { return growth < other.growth - rounding * std::abs(growth); }

  static constexpr double rounding = 1e-12;
};

// The action to take of those that are not barred, 0 if all are: of those that are nearly as good as the best, the one that earns
// soonest. A free look gains a little each time, and would put an end off for ever.
std::size_t soonest_of_best(const List<ExactValue>& values, FunctionRef<bool(std::size_t)> is_barred);

// Numbers of states with weights, by ascending numbers.
using Weighted = List<std::pair<std::uint32_t, double>>;

class ExactEvaluation {
 public:
  // The model must list all that `horizon` decisions can lead to from the beliefs that are evaluated. `values` are
  // prepared for that horizon.
  ExactEvaluation(const point_based::FlatModel& rows, const ObservableValues& values, ExactLimits limits)
      : rows_(rows), observable_(values), limits_(std::move(limits)) {}

  // The value of every action at a belief with `horizon` decisions to go. Throws NotEnumerable at a limit.
  List<ExactValue> action_values(const Weighted& belief, int horizon);

  // What missions that begin with an action lose of its value, since they plan anew at each step: as many of some missions
  // as the limits allow.
  List<double> losses(Weighted belief, std::size_t action, int horizon, ExactLimits limits);

  // How often, discounted, missions that begin with an action take each action in each state, if they decide best: the
  // expected rewards by these weights add up to the action's value. Throws NotEnumerable at a limit.
  std::map<std::pair<std::uint32_t, std::size_t>, double> occupancy(const Weighted& belief, std::size_t action, int horizon);

  // How far rounding may have moved a value with so many decisions to go, at most: that of sums, that of the keys of
  // beliefs, and ties.
  double error(int horizon) const;

  std::uint64_t beliefs() const { return evaluated_; }
  std::uint64_t work() const { return work_; }

 private:
  using Posteriors = std::map<std::uint32_t, std::map<std::uint32_t, double>>;

  ExactValue action_value(const Weighted& belief, std::size_t action, int horizon);
  Posteriors posteriors(const Weighted& belief, std::size_t action);
  double loss_of_mission(Weighted belief, std::size_t action, int horizon, Sampler& random);
  // Throws NotEnumerable when time is over, which is asked now and then.
  void look();
  std::size_t best_action(const Weighted& belief, int horizon);
  ExactValue best_value(Weighted belief, int horizon);
  ExactValue best_of_actions(const Weighted& belief, int horizon);
  double bound(const Weighted& belief, std::size_t action, int horizon) const;
  static BeliefKey key_of(const Weighted& belief);

  const point_based::FlatModel& rows_;
  const ObservableValues& observable_;
  ExactLimits limits_;
  std::uint64_t evaluated_ = 0;
  std::uint64_t work_ = 0;
  std::uint64_t looked_ = 0;  // the work at the last look at the clock
  std::unordered_map<std::size_t, std::unordered_map<BeliefKey, ExactValue, BeliefKey::Hash>> values_;
};

}
