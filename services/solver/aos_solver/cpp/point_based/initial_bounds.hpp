// Bounds to begin with: what always doing the same action gives, and what knowing more would give.
//
// Without an end there is one layer of them; with a horizon one for every number of decisions that are left.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "point_based/regions.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

// Values of a state's actions, [state * actions + action]; worthless and unreached states have 0.
using ActionValues = std::vector<double>;

struct TooLarge : std::length_error {
  using std::length_error::length_error;
};

// Both for so many actions, states and layers.
inline constexpr std::size_t max_layer_entries = std::size_t{1} << 25;

class InitialBounds {
 public:
  // `rounding` is relative, of the model's longest sum.
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
      for (const auto* outcome = model.outcomes.begin(row); outcome != model.outcomes.end(row); ++outcome) {
        sum += outcome->probability;
        readings_ += static_cast<double>(model.readings.end(outcome->sensing) - model.readings.begin(outcome->sensing));
      }
      most_probable_ = std::max(most_probable_, sum * (1 + rounding));
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

  // By layer: the decisions that are left, or 0 where there is no end.
  std::vector<ActionValues> informed;  // from above
  std::vector<ActionValues> blind;     // from below: that action, again and again

 private:
  // Work for one kind of bound; large models get so many sweeps at least.
  static constexpr double operations_ = 3e7;
  static constexpr double layer_operations_ = 4e8;
  static constexpr double least_sweeps_ = 30;
  // Sweeps end when no value changes by more than this share of the largest reward.
  static constexpr double settled_blind_ = 1e-3;
  static constexpr double settled_seen_ = 1e-6;

  // Sweeps until nothing changes much or the work is done.
  template <class Sweep>
  void repeat(double settled, double operations, double least_sweeps, Sweep&& sweep) const {
    const double sweeps = std::max(operations_ / (operations + 1), least_sweeps);
    for (double done = 0; done < sweeps; ++done) {
      if (sweep() <= settled * scale_) return;
    }
  }

  void add_layers() {
    const double actions = static_cast<double>(model_.actions);
    const bool looks = readings_ * actions * static_cast<double>(model_.horizon) <= layer_operations_;
    informed.assign(1, ActionValues(model_.states * model_.actions, 0.0));
    blind = informed;
    std::vector<double> best(model_.states, 0.0);
    Gathered gathered;
    gathered.slot_of.assign(model_.observations, 0);
    for (std::size_t left = 1; left <= model_.horizon; ++left) {
      ActionValues above(informed[0].size(), 0.0);
      ActionValues below = above;
      const ActionValues& later = informed.back();
      const ActionValues& same = blind.back();
      for (const std::uint32_t state : states_) {
        for (std::size_t action = 0; action < model_.actions; ++action) {
          const std::size_t row = model_.row(state, action);
          const Estimate seen = value_of(row, [&](std::uint32_t next) { return best[next]; });
          above[row] = looks ? informed_value(row, later, gathered) : seen.value + seen.error;
          const Estimate again = value_of(row, [&](std::uint32_t next) { return same[model_.row(next, action)]; });
          below[row] = again.value - again.error;
        }
      }
      for (const std::uint32_t state : states_) best[state] = best_of(above, state);
      informed.push_back(std::move(above));
      blind.push_back(std::move(below));
    }
  }

  double best_of(const ActionValues& values, std::uint32_t state) const {
    const auto* first = values.data() + model_.row(state, 0);
    return *std::max_element(first, first + model_.actions);
  }

  ActionValues endless_blind_values() const {
    ActionValues values(model_.states * model_.actions, 0.0);
    for (std::size_t action = 0; action < model_.actions; ++action) {
      const std::vector<double> same = endless_blind_values(action);
      for (const std::uint32_t state : states_) values[model_.row(state, action)] = same[state];
    }
    return values;
  }

  // Sweeps rise from the least there can be. Whatever they have come to: where doing the action once more takes no more
  // than c away, no value is further than c / (1 - discount) too high.
  std::vector<double> endless_blind_values(std::size_t action) const {
    std::vector<double> values(model_.states, 0.0);
    double lowest = 0;
    for (const std::uint32_t state : states_) lowest = std::min(lowest, model_.rewards[model_.row(state, action)]);
    for (const std::uint32_t state : states_) values[state] = lowest / (1 - model_.discount);
    const double operations = static_cast<double>(model_.outcomes.elements.size() / model_.actions);
    repeat(settled_blind_, operations, least_sweeps_, [&] {
      return sweep(values, [&](std::size_t number) {
        const std::uint32_t state = states_[number];
        return std::max(values[state], lasting_value(state, model_.row(state, action), values));
      });
    });
    double drop = 0;
    for (const std::uint32_t state : states_) {
      const Estimate again = value_of(model_.row(state, action), [&](std::uint32_t next) { return values[next]; });
      drop = std::max(drop, values[state] - again.value + again.error);
    }
    for (const std::uint32_t state : states_) values[state] -= summed_up(drop) + 4 * ulp * std::abs(values[state]);
    return values;
  }

  // Of somebody who sees the state after the next step (fast informed bound: Hauskrecht, 2000), begun with the values of
  // somebody who sees it always.
  ActionValues endless_informed_values() const {
    const std::vector<double> values = endless_seen_values();
    ActionValues above(model_.states * model_.actions, 0.0);
    for (const std::uint32_t state : states_) {
      for (std::size_t action = 0; action < model_.actions; ++action) {
        const std::size_t row = model_.row(state, action);
        const Estimate seen = value_of(row, [&](std::uint32_t next) { return values[next]; });
        above[row] = seen.value + seen.error;
      }
    }
    Gathered gathered;
    gathered.slot_of.assign(model_.observations, 0);
    repeat(settled_seen_, readings_ * static_cast<double>(model_.actions), 1, [&] {
      double change = 0;
      for (const std::uint32_t state : states_) {
        for (std::size_t action = 0; action < model_.actions; ++action) {
          const std::size_t row = model_.row(state, action);
          const double tighter = informed_value(row, above, gathered);
          change = std::max(change, above[row] - tighter);
          above[row] = std::min(above[row], tighter);
        }
      }
      return change;
    });
    return above;
  }

  // Sweeps from nothing settle sooner than from the most there can be; where one more decision lifts no value by more
  // than c, none is further than c / (1 - discount) too low.
  std::vector<double> endless_seen_values() const {
    const Rows<std::uint32_t> choices = different_rows();
    std::vector<double> values(model_.states, 0.0);
    const auto best = [&](std::size_t number, auto&& value) {
      double best_value = -std::numeric_limits<double>::infinity();
      const auto* last = choices.end(number);
      for (const auto* row = choices.begin(number); row != last; ++row) best_value = std::max(best_value, value(*row));
      return best_value;
    };
    const double settled = std::min(settled_seen_, settled_seen_ * 20 * (1 - model_.discount));
    repeat(settled, static_cast<double>(choices.elements.size()), least_sweeps_, [&] {
      return sweep(values, [&](std::size_t number) {
        return best(number, [&](std::size_t row) { return lasting_value(states_[number], row, values); });
      });
    });
    double lift = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) {
      const double once_more = best(number, [&](std::size_t row) {
        const Estimate value = value_of(row, [&](std::uint32_t next) { return values[next]; });
        return value.value + value.error;
      });
      lift = std::max(lift, once_more - values[states_[number]]);
    }
    const double most = summed_up(highest_);
    for (const std::uint32_t state : states_) {
      values[state] = std::min(values[state] + summed_up(lift) + 4 * ulp * std::abs(values[state]), most);
    }
    return values;
  }

  // At least what so much at every decision adds up to.
  double summed_up(double reward) const {
    return reward * (1 + 8 * ulp) / (1 - model_.discount * most_probable_ - 4 * ulp);
  }

  // The rows of each of `states_`, less those that do the same as one before, as looking here and looking there.
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
                 std::equal(model_.outcomes.begin(known), model_.outcomes.end(known), model_.outcomes.begin(row),
                            model_.outcomes.end(row), is_same);
        };
        const auto known = choices.elements.begin() + static_cast<std::ptrdiff_t>(first);
        if (std::any_of(known, choices.elements.end(), does_the_same)) continue;
        choices.elements.push_back(static_cast<std::uint32_t>(row));
      }
      choices.first.push_back(choices.elements.size());
    }
    return choices;
  }

  // There and back over `states_`, since values run along numbers that rise or that fall. Returns the largest change.
  template <class NewValue>
  double sweep(std::vector<double>& values, NewValue&& new_value) const {
    double change = 0;
    const auto renew = [&](std::size_t number) {
      double& value = values[states_[number]];
      const double renewed = new_value(number);
      change = std::max(change, std::abs(renewed - value));
      value = renewed;
    };
    for (std::size_t number = states_.size(); number-- > 0;) renew(number);
    if (change <= 1e-13 * scale_) return change;
    change = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) renew(number);
    return change;
  }

  // The value of an action that is repeated for as long as it leads nowhere else; a guess, that is put right afterwards.
  double lasting_value(std::uint32_t state, std::size_t row, const std::vector<double>& values) const {
    double later = 0;
    double stays = 0;
    for (const auto* outcome = model_.outcomes.begin(row); outcome != model_.outcomes.end(row); ++outcome) {
      if (outcome->next == state) {
        stays += outcome->probability;
      } else {
        later += outcome->probability * values[outcome->next];
      }
    }
    return (model_.rewards[row] + model_.discount * later) / (1 - model_.discount * stays);
  }

  struct Estimate {
    double value;
    double error;  // of rounding, at most
  };

  template <class ValueOf>
  Estimate value_of(std::size_t row, ValueOf&& value) const {
    double later = 0;
    double size = 0;
    for (const auto* outcome = model_.outcomes.begin(row); outcome != model_.outcomes.end(row); ++outcome) {
      const double part = outcome->probability * value(outcome->next);
      later += part;
      size += std::abs(part);
    }
    return {model_.rewards[row] + model_.discount * later, rounding_ * (std::abs(model_.rewards[row]) + size)};
  }

  // What the next actions are worth after each observation, with room that is used again.
  struct Gathered {
    std::vector<std::size_t> slot_of;
    std::vector<std::uint32_t> seen;
    std::vector<double> sums;  // [slot * actions + next action]
  };

  double informed_value(std::size_t row, const ActionValues& values, Gathered& gathered) const {
    const auto [later, size] = informed_later(row, values, gathered);
    const double value = model_.rewards[row] + model_.discount * later;
    return value + 2 * rounding_ * (std::abs(model_.rewards[row]) + size);
  }

  // The sum, and the size of what was added up.
  std::pair<double, double> informed_later(std::size_t row, const ActionValues& values, Gathered& gathered) const {
    const std::size_t actions = model_.actions;
    const auto* const first_outcome = model_.outcomes.begin(row);
    const auto* const last_outcome = model_.outcomes.end(row);
    if (last_outcome - first_outcome == 1) {  // no observation tells more
      const double later = first_outcome->probability * best_of(values, first_outcome->next);
      return {later, std::abs(later)};
    }
    auto& [slot_of, seen, sums] = gathered;
    seen.clear();
    sums.clear();
    double size = 0;
    for (const auto* outcome = first_outcome; outcome != last_outcome; ++outcome) {
      const double* next = values.data() + model_.row(outcome->next, 0);
      double largest = 0;
      for (std::size_t i = 0; i < actions; ++i) largest = std::max(largest, std::abs(next[i]));
      size += outcome->probability * largest;
      const auto* last = model_.readings.end(outcome->sensing);
      for (const auto* reading = model_.readings.begin(outcome->sensing); reading != last; ++reading) {
        std::size_t& slot = slot_of[reading->observation];
        if (slot >= seen.size() || seen[slot] != reading->observation) {
          slot = seen.size();
          seen.push_back(reading->observation);
          sums.resize(seen.size() * actions, 0.0);
        }
        double* sum = sums.data() + slot * actions;
        const double weight = outcome->probability * reading->probability;
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
  std::vector<std::uint32_t> states_;
  double readings_ = 0;  // of all outcomes
  double highest_ = 0;
  double scale_ = 1e-300;
  double most_probable_ = 1;  // the largest sum of a row's probabilities
};

}  // namespace aos::point_based
