// Exact finite-horizon values, by enumerating every observation of every action. Searches are measured
// against these values, and a planner uses them if they fit the budget.
//
// A belief is a sorted list of (state number, weight) without its ended part, which is worth nothing. Equal
// beliefs at equal depth are evaluated once. Below the root, an action is left out if its fully observable
// value is no higher than the value of another action. Of two actions with the same value, the one that earns
// sooner is better: otherwise a free exit could be put off for ever.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/progress.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/state_space.hpp"

namespace aos {

// The limits of an evaluation: distinct beliefs, work (0: no limit), and `is_over`.
struct ExactLimits {
  std::uint64_t beliefs = 0;
  Operations work = 0;
  std::function<bool()> is_over = [] { return false; };
};

// The value of an action or a belief, and its derivative by the discount, which is smaller if rewards come sooner.
struct ExactValue {
  double value = 0;
  double growth = 0;

  // Whether this value is higher than another one, or as high and earned sooner.
  bool is_better_than(const ExactValue& other) const {
    constexpr double rounding = 1e-12;
    const double tie = rounding * (std::abs(value) + std::abs(other.value));
    return value > other.value + tie || (value >= other.value - tie && growth < other.growth - rounding * std::abs(growth));
  }
};

// The fully observable (MDP) values of a space's states, by decisions to go, from 0 on. Bounds of exact values.
template <class Model>
class ObservableValues {
 public:
  ObservableValues() = default;
  ObservableValues(const StateSpace<Model>& space, int horizon) { prepare(space, horizon); }

  // Computes the values for fewer than `horizon` decisions, or none if there are too many. What is known is kept.
  void prepare(const StateSpace<Model>& space, int horizon) {
    constexpr std::size_t max_values = 4'000'000;
    if (numbering_ != space.numbering()) layers_.clear();
    numbering_ = space.numbering();
    if (space.size() * static_cast<std::size_t>(horizon) > max_values) return layers_.clear();
    if (layers_.empty()) layers_.emplace_back(space.size(), 0.0);
    for (auto left = static_cast<int>(layers_.size()); left < horizon; ++left) {
      progress::tell("computing values of states", static_cast<std::uint64_t>(left), static_cast<std::uint64_t>(horizon));
      std::vector<double> values(space.size(), std::numeric_limits<double>::infinity());
      for (std::uint32_t state = 0; state < space.rows().states; ++state) {
        double best = -std::numeric_limits<double>::infinity();
        for (std::size_t action = 0; action < space.actions(); ++action) {
          best = std::max(best, value(space.rows(), state, action, layers_.back()));
        }
        values[state] = best;
      }
      layers_.push_back(std::move(values));
    }
  }
  std::size_t layers() const { return layers_.size(); }
  const std::vector<double>& layer(int left) const { return layers_[static_cast<std::size_t>(left)]; }
  // The value of an action, from those of the states after it.
  static double value(const point_based::FlatModel& rows, std::uint32_t state, std::size_t action, const std::vector<double>& later) {
    const std::size_t row = rows.row(state, action);
    return rows.rewards[row] + Model::discount * rows.later_value(row, later);
  }

 private:
  Numbering numbering_;
  std::vector<std::vector<double>> layers_;
};

template <class Model>
class ExactEvaluation {
 public:
  // The space must list all that `horizon` decisions can lead to from the beliefs that are evaluated. `values` are
  // prepared for that horizon.
  ExactEvaluation(const StateSpace<Model>& space, const ObservableValues<Model>& values, ExactLimits limits)
      : space_(space), observable_(values), limits_(std::move(limits)) {}

  // The value of every action at a belief with `horizon` decisions to go. Throws NotEnumerable at a limit.
  std::vector<ExactValue> action_values(const Belief<Model>& belief, int horizon) {
    if (!space_.lists_observations()) throw NotEnumerable{numbers_are_observed};
    if (!belief.is_exact()) throw NotEnumerable{"the belief is only known by samples"};
    const Weighted root = space_.weights_of(belief);
    std::vector<ExactValue> values(space_.actions());
    if (horizon <= 0 || root.empty()) return values;
    for (std::size_t action = 0; action < values.size(); ++action) values[action] = action_value(root, action, horizon);
    return values;
  }

  // What missions that begin with an action lose of its value, since they plan anew at each step: as many of some missions
  // as the limits allow.
  std::vector<double> losses(const Belief<Model>& belief, std::size_t action, int horizon, ExactLimits limits) {
    constexpr std::size_t missions = 30;
    std::vector<double> found;
    Weighted root = space_.weights_of(belief);
    double total = 0;
    for (const auto& part : root) total += part.second;
    if (total <= 0) return found;
    for (auto& part : root) part.second /= total;
    limits_ = std::move(limits);
    if (limits_.work > 0) limits_.work += work_;
    limits_.beliefs += evaluated_;
    Sampler random{1};
    try {
      while (found.size() < missions) found.push_back(total * loss_of_mission(root, action, horizon, random));
    } catch (const NotEnumerable&) {
      // What was found counts.
    }
    return found;
  }

  // How often, discounted, missions that begin with an action take each action in each state, if they decide best: the
  // expected rewards by these weights add up to the action's value. Throws NotEnumerable at a limit.
  std::map<std::pair<std::uint32_t, std::size_t>, double> occupancy(const Belief<Model>& belief, std::size_t action, int horizon) {
    struct Visit {
      Weighted belief;  // of sum 1
      double weight = 0;
    };
    std::map<std::pair<std::uint32_t, std::size_t>, double> found;
    std::unordered_map<BeliefKey, Visit, KeyHash> level;
    const auto add = [](auto& visits, Weighted states, double weight) {
      double total = 0;
      for (const auto& part : states) total += part.second;
      if (total <= 0) return;
      for (auto& part : states) part.second /= total;
      Visit& visit = visits[key_of(states)];
      visit.weight += weight * total;
      if (visit.belief.empty()) visit.belief = std::move(states);
    };
    add(level, space_.weights_of(belief), 1);
    for (int left = horizon; left > 0 && !level.empty(); --left) {
      std::unordered_map<BeliefKey, Visit, KeyHash> next;
      for (const auto& [key, visit] : level) {
        const std::size_t chosen = left == horizon ? action : best_action(visit.belief, left);
        for (const auto& [state, weight] : visit.belief) found[{state, chosen}] += visit.weight * weight;
        if (left == 1) continue;
        for (const auto& [observation, states] : posteriors(visit.belief, chosen)) {
          add(next, {states.begin(), states.end()}, visit.weight * Model::discount);
        }
      }
      level = std::move(next);
    }
    return found;
  }

  // How far rounding may have moved a value with so many decisions to go, at most: that of sums, that of the keys of
  // beliefs, and ties.
  double error(int horizon) const {
    double largest = 0;
    for (const double reward : rows().rewards) largest = std::max(largest, std::abs(reward));
    const double once = 1e-12 * (4 + static_cast<double>(space_.size()));
    return once * largest * horizon * horizon;
  }

  std::uint64_t beliefs() const { return evaluated_; }
  Operations work() const { return work_; }

 private:
  static constexpr Operations per_outcome = 80;  // that is added to a posterior
  static constexpr Operations per_bound = 10;    // of an action in a state
  static constexpr Operations per_belief = 300;

  using Weighted = std::vector<std::pair<std::uint32_t, double>>;

  struct BeliefKey {
    std::uint64_t high, low;
    bool operator==(const BeliefKey&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const BeliefKey& key) const { return key.high ^ key.low; }
  };

  const point_based::FlatModel& rows() const { return space_.rows(); }

  // Posteriors are not normalised here: a weight is the probability of getting to that state.
  ExactValue action_value(const Weighted& belief, std::size_t action, int horizon) {
    ExactValue result;
    for (const auto& [state, weight] : belief) result.value += weight * rows().rewards[rows().row(state, action)];
    if (horizon == 1) return result;
    for (const auto& [observation, states] : posteriors(belief, action)) {
      const ExactValue later = best_value({states.begin(), states.end()}, horizon - 1);
      result.value += Model::discount * later.value;
      result.growth += later.value + Model::discount * later.growth;
    }
    return result;
  }

  // The weights of the states after an action, by what is observed.
  std::map<std::uint32_t, std::map<std::uint32_t, double>> posteriors(const Weighted& belief, std::size_t action) {
    std::map<std::uint32_t, std::map<std::uint32_t, double>> result;
    for (const auto& [state, weight] : belief) {
      for (const auto& outcome : rows().outcomes[rows().row(state, action)]) {
        for (const auto& likelihood : rows().likelihoods[outcome.sensing]) {
          result[likelihood.observation][outcome.next] += weight * outcome.probability * likelihood.probability;
          work_ += per_outcome;
        }
      }
    }
    if (limits_.work > 0 && work_ > limits_.work) throw NotEnumerable{"there are more outcomes than the budget"};
    return result;
  }

  // What a mission loses of an action's value if it plans a whole horizon anew at each later decision. It may put off for
  // ever what is best at the end of a horizon.
  double loss_of_mission(Weighted belief, std::size_t action, int horizon, Sampler& random) {
    double loss = 0;
    double discount = 1;
    for (int left = horizon; left > 1; --left) {
      // Where the mission has ended, nothing is observed.
      double place = random.uniform();
      Weighted next;
      for (const auto& [observation, states] : posteriors(belief, action)) {
        double total = 0;
        for (const auto& part : states) total += part.second;
        if (place < total) {
          next.assign(states.begin(), states.end());
          for (auto& part : next) part.second /= total;
          break;
        }
        place -= total;
      }
      if (next.empty()) break;
      belief = std::move(next);
      discount *= Model::discount;
      action = best_action(belief, horizon);
      loss += discount * (best_value(belief, left - 1).value - action_value(belief, action, left - 1).value);
    }
    return loss;
  }
  std::size_t best_action(const Weighted& belief, int horizon) {
    std::size_t best = 0;
    ExactValue highest = action_value(belief, best, horizon);
    for (std::size_t action = 1; action < space_.actions(); ++action) {
      const ExactValue value = action_value(belief, action, horizon);
      if (!value.is_better_than(highest)) continue;
      highest = value;
      best = action;
    }
    return best;
  }

  ExactValue best_value(Weighted belief, int horizon) {
    double total = 0;
    for (const auto& part : belief) total += part.second;
    if (total <= 0) return {};
    for (auto& part : belief) part.second /= total;

    auto& known = values_[static_cast<std::size_t>(horizon)];
    const BeliefKey key = key_of(belief);
    if (const auto found = known.find(key); found != known.end()) return scaled(found->second, total);
    if (++evaluated_ > limits_.beliefs) throw NotEnumerable{"more beliefs than the budget can be reached"};
    if (evaluated_ % 64 == 0) progress::tell("evaluating beliefs", evaluated_);
    if (evaluated_ % 64 == 0 && limits_.is_over()) throw NotEnumerable{"it takes longer than allowed"};
    const ExactValue best = best_of_actions(belief, horizon);
    known.emplace(key, best);
    return scaled(best, total);
  }
  static ExactValue scaled(ExactValue value, double by) { return {by * value.value, by * value.growth}; }

  // Evaluates the actions in the order of their bounds.
  ExactValue best_of_actions(const Weighted& belief, int horizon) {
    std::vector<std::pair<double, std::size_t>> order;
    work_ += per_belief + per_bound * belief.size() * space_.actions();
    for (std::size_t action = 0; action < space_.actions(); ++action) order.emplace_back(-bound(belief, action, horizon), action);
    std::sort(order.begin(), order.end());
    ExactValue best = action_value(belief, order.front().second, horizon);
    for (std::size_t next = 1; next < order.size() && -order[next].first > best.value; ++next) {
      const ExactValue candidate = action_value(belief, order[next].second, horizon);
      if (candidate.is_better_than(best)) best = candidate;
    }
    return best;
  }

  // An upper bound of the action's value; infinite if none is known.
  double bound(const Weighted& belief, std::size_t action, int horizon) const {
    if (static_cast<std::size_t>(horizon) > observable_.layers()) return std::numeric_limits<double>::infinity();
    const std::vector<double>& later = observable_.layer(horizon - 1);
    double sum = 0;
    double magnitude = 0;
    for (const auto& [state, weight] : belief) {
      const double value = weight * ObservableValues<Model>::value(rows(), state, action, later);
      sum += value;
      magnitude += std::abs(value);
    }
    const double rounding = 1e-15 * static_cast<double>(100 + belief.size());
    return sum + rounding * magnitude;
  }

  // Probabilities are rounded to 1e-13, so that sums of the same terms in different orders give the same key.
  static BeliefKey key_of(const Weighted& belief) {
    BeliefKey key{0x9ae16a3b2f90404fu, 0xc949d7c7509e6557u};
    for (const auto& [number, weight] : belief) {
      const auto rounded = static_cast<std::uint64_t>(std::llround(weight * 1e13));
      key.high = mixed(key.high, rounded * 31 + number);
      key.low = mixed(key.low ^ number, rounded);
    }
    return key;
  }

  const StateSpace<Model>& space_;
  const ObservableValues<Model>& observable_;
  ExactLimits limits_;
  std::uint64_t evaluated_ = 0;
  Operations work_ = 0;
  std::unordered_map<std::size_t, std::unordered_map<BeliefKey, ExactValue, KeyHash>> values_;
};

}  // namespace aos
