// Initial bounds. The lower ones repeat one action; the upper ones are for a robot that knows more than it does.
//
// Without a horizon they have one layer; with a horizon, one for each number of decisions that are left.
#pragma once

#include <cmath>
#include <stdexcept>

#include "aos/base/progress.hpp"
#include "point_based/regions.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

// Values of a state's actions, [state * actions + action]. Worthless and unreached states have 0.
using ActionValues = List<double>;

struct TooLarge : std::length_error {
  using std::length_error::length_error;
};

// The largest number of states times actions times layers of one kind of bound.
inline constexpr std::size_t max_layer_entries = std::size_t{1} << 25;

class InitialBounds {
 public:
  // `rounding` is the relative error of the model's longest sum. Throws TooLarge.
  InitialBounds(const FlatModel& model, const Regions& regions, double rounding)
      : model_(model), regions_(regions), rounding_(rounding) {
    for (std::size_t state = 0; state < model.states; ++state) {
      if (regions.region_of[state] != nowhere) states_.push_back(static_cast<std::uint32_t>(state));
    }
    for (const double reward : model.rewards) {
      highest_ = std::max(highest_, reward);
      scale_ = std::max(scale_, std::abs(reward));
    }
    for (std::size_t row = 0; row < model.states * model.actions; ++row) {
      double sum = 0;
      for (const auto& outcome : model.outcomes[row]) {
        sum += outcome.probability;
        likelihoods_ += static_cast<double>(model.likelihoods[outcome.sensing].size());
      }
      max_row_sum_ = std::max(max_row_sum_, sum * (1 + rounding));
    }
    if (model.horizon > 0) {
      if (model.horizon > max_layer_entries / (model.states * model.actions + 1)) {
        throw TooLarge("too many states for so many decisions ahead");
      }
      add_layers();
    } else {
      blind.push_back(endless_blind_values());
      informed.push_back(endless_informed_values());
    }
  }

  // By layer: the number of decisions that are left, or 0 without a horizon.
  List<ActionValues> informed;  // upper bounds
  List<ActionValues> blind;     // lower bounds: the action is repeated

 private:
  // The work for one kind of bound; large models get at least `min_sweeps_` sweeps.
  static constexpr double operations_ = 1e7;
  static constexpr double layer_operations_ = 4e8;
  static constexpr double min_sweeps_ = 30;
  // Sweeps end when values are known to this share of the largest reward.
  static constexpr double settled_ = 1e-6;

  // Calls `use(row)` for each action of `states_`.
  void for_each_row(auto&& use) const {
    for (const std::uint32_t state : states_) {
      for (std::size_t action = 0; action < model_.actions; ++action) use(model_.row(state, action));
    }
  }

  void add_layers() {
    const double actions = static_cast<double>(model_.actions);
    const bool looks = likelihoods_ * actions * static_cast<double>(model_.horizon) <= layer_operations_;
    informed.assign(1, ActionValues(model_.states * model_.actions, 0.0));
    blind = informed;
    List<double> best(model_.states, 0.0);
    Gathered gathered;
    gathered.slot_of.assign(model_.observations, 0);
    for (std::size_t left = 1; left <= model_.horizon; ++left) {
      aos::progress::tell("computing first bounds", left, model_.horizon);
      ActionValues above(informed[0].size(), 0.0);
      ActionValues below = above;
      const ActionValues& later = informed.back();
      const ActionValues& same = blind.back();
      for_each_row([&](std::size_t row) {
        const std::size_t action = row % model_.actions;
        const Estimate seen = value_of(row, [&](std::uint32_t next) { return best[next]; });
        above[row] = looks ? informed_value(row, later, gathered) : seen.value + seen.error;
        const Estimate again = value_of(row, [&](std::uint32_t next) { return same[model_.row(next, action)]; });
        below[row] = again.value - again.error;
      });
      for (const std::uint32_t state : states_) best[state] = best_of(above, state);
      informed.push_back(std::move(above));
      blind.push_back(std::move(below));
    }
  }

  double best_of(const ActionValues& values, std::uint32_t state) const { return std::ranges::max(model_.of_actions(values, state)); }

  ActionValues endless_blind_values() const {
    ActionValues values(model_.states * model_.actions, 0.0);
    for (std::size_t action = 0; action < model_.actions; ++action) {
      Rows<std::uint32_t> rows;
      double lowest = 0;
      for (const std::uint32_t state : states_) {
        rows.first.push_back(rows.elements.size());
        rows.elements.push_back(static_cast<std::uint32_t>(model_.row(state, action)));
        lowest = std::min(lowest, model_.rewards[rows.elements.back()]);
      }
      rows.first.push_back(rows.elements.size());
      const List<double> same = settled_values(rows);
      const double shift = shift_of(same, rows).min;
      for (const std::uint32_t state : states_) {
        const double value = same[state] + shift;
        values[model_.row(state, action)] =
            std::max(value - 4 * ulp * (std::abs(same[state]) + std::abs(shift)), summed_up(lowest));
      }
    }
    return values;
  }

  // Upper bounds for a robot that observes the state after the next step (fast informed bound: Hauskrecht,
  // 2000). The sweeps begin with the fully observable values.
  ActionValues endless_informed_values() const {
    const List<double> values = endless_mdp_values();
    ActionValues above(model_.states * model_.actions, 0.0);
    for_each_row([&](std::size_t row) {
      const Estimate seen = value_of(row, [&](std::uint32_t next) { return values[next]; });
      above[row] = seen.value + seen.error;
    });
    Gathered gathered;
    gathered.slot_of.assign(model_.observations, 0);
    const double sweeps = std::max(operations_ / (likelihoods_ * static_cast<double>(model_.actions) + 1), 1.0);
    double change = std::numeric_limits<double>::infinity();
    for (double done = 0; done < sweeps && change > settled_ * scale_; ++done) {
      change = 0;
      for_each_row([&](std::size_t row) {
        const double tighter = informed_value(row, above, gathered);
        change = std::max(change, above[row] - tighter);
        above[row] = std::min(above[row], tighter);
      });
    }
    return above;
  }

  // Upper bounds of the fully observable values.
  List<double> endless_mdp_values() const {
    const Rows<std::uint32_t> choices = different_rows();
    List<double> values = settled_values(choices);
    const double shift = shift_of(values, choices).max;
    for (const std::uint32_t state : states_) {
      const double value = values[state] + shift + 4 * ulp * (std::abs(values[state]) + std::abs(shift));
      values[state] = std::min(value, summed_up(highest_));
    }
    return values;
  }

  // The approximate value of each state's best row, by sweeps until all states are off by nearly the same.
  List<double> settled_values(const Rows<std::uint32_t>& choices) const {
    List<double> values(model_.states, 0.0);
    double outcomes = 0;
    for (const std::uint32_t row : choices.elements) outcomes += static_cast<double>(model_.outcomes[row].size());
    const double sweeps = std::max(operations_ / (outcomes + 1), min_sweeps_);
    double next_look = 4;
    for (double done = 1; done <= sweeps; ++done) {
      if (sweep(values, choices) <= 1e-13 * scale_) break;
      if (done < next_look) continue;
      const Shift shift = shift_of(values, choices);
      if (shift.max - shift.min <= settled_ * scale_) break;
      next_look *= 1.5;
    }
    return values;
  }

  // The range of the number that has to be added to the value of every state. If one more decision by a row adds d to a
  // state's value and the mission goes on with probability p, values higher by d / (1 - discount p) stay as they are.
  // With the highest of these numbers no value rises; with the lowest one of the states' best rows no value falls.
  struct Shift {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
  };

  Shift shift_of(const List<double>& values, const Rows<std::uint32_t>& choices) const {
    Shift shift;
    for (std::size_t number = 0; number < states_.size(); ++number) {
      double best = -std::numeric_limits<double>::infinity();
      for (const auto& row : choices[number]) {
        const Estimate again = value_of(row, [&](std::uint32_t next) { return values[next]; });
        const double added = again.value - values[states_[number]];
        const double error = again.error + ulp * std::abs(values[states_[number]]);
        const double share = 1 - model_.discount * going_on(row);
        const auto divided = [&](double by, int direction) {
          return by / (share - direction * (by < 0 ? -1 : 1) * rounding_) * (1 + direction * (by < 0 ? -1 : 1) * 4 * ulp);
        };
        shift.max = std::max(shift.max, divided(added + error, 1));
        best = std::max(best, divided(added - error, -1));
      }
      shift.min = std::min(shift.min, best);
    }
    return states_.empty() ? Shift{0, 0} : shift;
  }

  double going_on(std::size_t row) const {
    double sum = 0;
    for (const auto& outcome : model_.outcomes[row]) {
      if (regions_.region_of[outcome.next] != nowhere) sum += outcome.probability;
    }
    return sum;
  }

  // The value of a reward at every decision, and a little more in size.
  double summed_up(double reward) const {
    return reward * (1 + 8 * ulp) / (1 - model_.discount * max_row_sum_ - 4 * ulp);
  }

  // The rows of each of `states_` without repetitions: actions that only observe differently have the same row.
  Rows<std::uint32_t> different_rows() const {
    Rows<std::uint32_t> choices;
    choices.first.push_back(0);
    const auto is_same = [](const Outcome& one, const Outcome& other) {
      return one.next == other.next && one.probability == other.probability;
    };
    for (const std::uint32_t state : states_) {
      const std::uint64_t first = choices.elements.size();
      for (std::size_t action = 0; action < model_.actions; ++action) {
        const std::size_t row = model_.row(state, action);
        const auto does_the_same = [&](std::size_t known) {
          return model_.rewards[known] == model_.rewards[row] &&
                 std::ranges::equal(model_.outcomes[known], model_.outcomes[row], is_same);
        };
        const auto known = choices.elements.begin() + static_cast<std::ptrdiff_t>(first);
        if (std::any_of(known, choices.elements.end(), does_the_same)) continue;
        choices.elements.push_back(static_cast<std::uint32_t>(row));
      }
      choices.first.push_back(choices.elements.size());
    }
    return choices;
  }

  // Sweeps `states_` in both directions, since values spread along their numbers. Returns the largest change.
  double sweep(List<double>& values, const Rows<std::uint32_t>& choices) const {
    double change = 0;
    const auto renew = [&](std::size_t number) {
      double& value = values[states_[number]];
      double renewed = -std::numeric_limits<double>::infinity();
      for (const auto& row : choices[number]) renewed = std::max(renewed, lasting_value(states_[number], row, values));
      change = std::max(change, std::abs(renewed - value));
      value = renewed;
    };
    for (std::size_t number = states_.size(); number-- > 0;) renew(number);
    if (change <= 1e-13 * scale_) return change;
    change = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) renew(number);
    return change;
  }

  // The value of an action that is repeated as long as it leads nowhere else. `shift_of` corrects this estimate later.
  double lasting_value(std::uint32_t state, std::size_t row, const List<double>& values) const {
    double later = 0;
    double stays = 0;
    for (const auto& outcome : model_.outcomes[row]) {
      if (outcome.next == state) stays += outcome.probability;
      else later += outcome.probability * values[outcome.next];
    }
    return (model_.rewards[row] + model_.discount * later) / (1 - model_.discount * stays);
  }

  struct Estimate {
    double value;
    double error;  // an upper bound of the rounding error
  };

  Estimate value_of(std::size_t row, auto&& value) const {
    double later = 0;
    double size = 0;
    for (const auto& outcome : model_.outcomes[row]) {
      const double part = outcome.probability * value(outcome.next);
      later += part;
      size += std::abs(part);
    }
    return {model_.rewards[row] + model_.discount * later, rounding_ * (std::abs(model_.rewards[row]) + size)};
  }

  // The values of the next actions after each observation. The memory is used again.
  struct Gathered {
    List<std::size_t> slot_of;
    List<std::uint32_t> seen;
    List<double> sums;  // [slot * actions + next action]
  };

  double informed_value(std::size_t row, const ActionValues& values, Gathered& gathered) const {
    const auto [later, size] = informed_later(row, values, gathered);
    const double value = model_.rewards[row] + model_.discount * later;
    return value + 2 * rounding_ * (std::abs(model_.rewards[row]) + size);
  }

  // The expected value of the best next actions, and the sum of the absolute values in it.
  std::pair<double, double> informed_later(std::size_t row, const ActionValues& values, Gathered& gathered) const {
    const std::size_t actions = model_.actions;
    const auto outcomes = model_.outcomes[row];
    if (outcomes.size() == 1) {  // no observation tells more
      const double later = outcomes[0].probability * best_of(values, outcomes[0].next);
      return {later, std::abs(later)};
    }
    auto& [slot_of, seen, sums] = gathered;
    seen.clear();
    sums.clear();
    double size = 0;
    for (const Outcome& outcome : outcomes) {
      const auto next = model_.of_actions(values, outcome.next);
      double largest = 0;
      for (std::size_t i = 0; i < actions; ++i) largest = std::max(largest, std::abs(next[i]));
      size += outcome.probability * largest;
      for (const auto& likelihood : model_.likelihoods[outcome.sensing]) {
        std::size_t& slot = slot_of[likelihood.observation];
        if (slot >= seen.size() || seen[slot] != likelihood.observation) {
          slot = seen.size();
          seen.push_back(likelihood.observation);
          sums.resize(seen.size() * actions, 0.0);
        }
        double* sum = sums.data() + slot * actions;
        const double weight = outcome.probability * likelihood.probability;
        for (std::size_t i = 0; i < actions; ++i) sum[i] += weight * next[i];
      }
    }
    double later = 0;
    for (std::size_t slot = 0; slot < seen.size(); ++slot) {
      const double* first = sums.data() + slot * actions;
      later += *std::max_element(first, first + actions);
    }
    return {later, size};
  }

  const FlatModel& model_;
  const Regions& regions_;
  double rounding_;
  List<std::uint32_t> states_;
  double likelihoods_ = 0;  // of all outcomes
  double highest_ = 0;
  double scale_ = 1e-300;
  double max_row_sum_ = 1;  // of probabilities
};

}
