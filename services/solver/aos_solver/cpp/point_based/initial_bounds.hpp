// Bounds to begin with: what always doing the same action gives, and what knowing more would give.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "point_based/regions.hpp"

namespace aos::point_based {

// Values of a state's actions, [state * actions + action]; `model.states` rows, worthless and unreached ones are 0.
using ActionValues = std::vector<double>;

// Sweeps end when no value changes by more than this share of the largest reward.
inline constexpr double settled_blind = 1e-3;
inline constexpr double settled_informed = 1e-6;

class InitialBounds {
 public:
  InitialBounds(const FlatModel& model, const Regions& regions) : model_(model), regions_(regions) {
    for (std::size_t state = 0; state < model.states; ++state) {
      if (regions.region_of[state] != nowhere) states_.push_back(static_cast<std::uint32_t>(state));
    }
    scale_ = 1e-9;
    for (const double reward : model.rewards) {
      highest_ = std::max(highest_, reward);
      scale_ = std::max(scale_, std::abs(reward));
    }
    entries_ = model.outcomes.elements.size();
  }

  // The value of doing one action for ever, from below; by state.
  std::vector<double> blind_values(std::size_t action) const {
    std::vector<double> values(model_.states, 0.0);
    double lowest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t state : states_) lowest = std::min(lowest, model_.rewards[model_.row(state, action)]);
    for (const std::uint32_t state : states_) values[state] = std::min(lowest, 0.0) / (1 - model_.discount);
    repeat(settled_blind, entries_ / model_.actions, least_sweeps_, [&] {
      return sweep(values, [&](std::size_t number) {
        const std::uint32_t state = states_[number];
        return std::max(values[state], lasting_value(state, model_.row(state, action), values));
      });
    });
    return values;
  }

  // Values of somebody who sees the state after the next step (fast informed bound: Hauskrecht, 2000), begun with
  // those of somebody who sees it always; from above.
  ActionValues informed_values() const {
    const std::vector<double> values = seen_values();
    ActionValues informed(model_.states * model_.actions, 0.0);
    for (const std::uint32_t state : states_) {
      for (std::size_t action = 0; action < model_.actions; ++action) {
        const std::size_t row = model_.row(state, action);
        informed[row] = value_of(row, values);
      }
    }
    tighten(informed);
    return informed;
  }

 private:
  // Work for one kind of bound; large models get so many sweeps at least.
  static constexpr double operations_ = 3e7;
  static constexpr int least_sweeps_ = 30;

  // Sweeps until nothing changes much or the work is done.
  template <class Sweep>
  void repeat(double settled, std::size_t operations, int least_sweeps, Sweep&& sweep) const {
    const double sweeps = std::max(operations_ / (static_cast<double>(operations) + 1), double(least_sweeps));
    for (double done = 0; done < sweeps; ++done) {
      if (sweep() <= settled * scale_) return;
    }
  }

  // Of somebody who always sees the state; from above. Sweeps from nothing settle sooner than from the most there can be;
  // where one more decision lifts no value by more than c, none is further than c / (1 - discount) too low.
  std::vector<double> seen_values() const {
    const Rows<std::uint32_t> choices = different_rows();
    std::vector<double> values(model_.states, 0.0);
    const auto best = [&](std::size_t number, auto&& value) {
      double best_value = -std::numeric_limits<double>::infinity();
      const auto* last = choices.end(number);
      for (const auto* row = choices.begin(number); row != last; ++row) best_value = std::max(best_value, value(*row));
      return best_value;
    };
    repeat(settled_informed, choices.elements.size(), least_sweeps_, [&] {
      return sweep(values, [&](std::size_t number) {
        return best(number, [&](std::size_t row) { return lasting_value(states_[number], row, values); });
      });
    });
    double lift = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) {
      const double once_more = best(number, [&](std::size_t row) { return value_of(row, values); });
      lift = std::max(lift, once_more - values[states_[number]]);
    }
    const double most = highest_ / (1 - model_.discount);
    for (const std::uint32_t state : states_) {
      values[state] = std::min(values[state] + lift / (1 - model_.discount), most);
    }
    return values;
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
    if (change <= settled_informed * scale_) return change;
    change = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) renew(number);
    return change;
  }

  // The value of an action that is repeated for as long as it leads nowhere else.
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

  double value_of(std::size_t row, const std::vector<double>& values) const {
    double later = 0;
    for (const auto* outcome = model_.outcomes.begin(row); outcome != model_.outcomes.end(row); ++outcome) {
      later += outcome->probability * values[outcome->next];
    }
    return model_.rewards[row] + model_.discount * later;
  }

  void tighten(ActionValues& values) const {
    Gathered gathered;
    gathered.slot_of.assign(model_.observations, 0);
    repeat(settled_informed, entries_ * model_.actions, 1, [&] {
      double change = 0;
      for (const std::uint32_t state : states_) {
        for (std::size_t action = 0; action < model_.actions; ++action) {
          const std::size_t row = model_.row(state, action);
          const double tighter = model_.rewards[row] + model_.discount * informed_later(row, values, gathered);
          change = std::max(change, values[row] - tighter);
          values[row] = std::min(values[row], tighter);
        }
      }
      return change;
    });
  }

  // What the next actions are worth after each observation, with room that is used again.
  struct Gathered {
    std::vector<std::size_t> slot_of;
    std::vector<std::uint32_t> seen;
    std::vector<double> sums;  // [slot * actions + next action]
  };

  double informed_later(std::size_t row, const ActionValues& values, Gathered& gathered) const {
    const std::size_t actions = model_.actions;
    const auto* const first_outcome = model_.outcomes.begin(row);
    const auto* const last_outcome = model_.outcomes.end(row);
    if (last_outcome - first_outcome == 1) {  // no observation tells more
      const double* next = values.data() + model_.row(first_outcome->next, 0);
      return first_outcome->probability * *std::max_element(next, next + actions);
    }
    auto& [slot_of, seen, sums] = gathered;
    seen.clear();
    sums.clear();
    for (const auto* outcome = first_outcome; outcome != last_outcome; ++outcome) {
      const double* next = values.data() + model_.row(outcome->next, 0);
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
      const auto first = sums.begin() + static_cast<std::ptrdiff_t>(slot * actions);
      later += *std::max_element(first, first + static_cast<std::ptrdiff_t>(actions));
    }
    return later;
  }

  const FlatModel& model_;
  const Regions& regions_;
  std::vector<std::uint32_t> states_;
  std::size_t entries_ = 0;
  double highest_ = 0;
  double scale_ = 0;
};

}  // namespace aos::point_based
