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
      double change = 0;
      for (const std::uint32_t state : states_) {
        const double better = value_of(state, action, values);
        change = std::max(change, better - values[state]);
        values[state] = std::max(values[state], better);
      }
      return change;
    });
    return values;
  }

  // Values of somebody who sees the state after the next step (fast informed bound: Hauskrecht, 2000), begun with
  // those of somebody who sees it always; from above.
  ActionValues informed_values() const {
    std::vector<double> values(model_.states, 0.0);
    for (const std::uint32_t state : states_) values[state] = highest_ / (1 - model_.discount);
    repeat(settled_informed, entries_, least_sweeps_, [&] {
      double change = 0;
      for (const std::uint32_t state : states_) {
        double best = -std::numeric_limits<double>::infinity();
        for (std::size_t action = 0; action < model_.actions; ++action) {
          best = std::max(best, value_of(state, action, values));
        }
        change = std::max(change, values[state] - best);
        values[state] = std::min(values[state], best);
      }
      return change;
    });
    ActionValues informed(model_.states * model_.actions, 0.0);
    for (const std::uint32_t state : states_) {
      for (std::size_t action = 0; action < model_.actions; ++action) {
        informed[model_.row(state, action)] = value_of(state, action, values);
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

  double value_of(std::uint32_t state, std::size_t action, const std::vector<double>& values) const {
    const std::size_t row = model_.row(state, action);
    double later = 0;
    for (const auto* outcome = model_.outcomes.begin(row); outcome != model_.outcomes.end(row); ++outcome) {
      later += outcome->probability * values[outcome->next];
    }
    return model_.rewards[row] + model_.discount * later;
  }

  void tighten(ActionValues& values) const {
    const std::size_t actions = model_.actions;
    std::vector<std::size_t> slot_of(model_.observations, 0);
    std::vector<std::uint32_t> seen;
    std::vector<double> gathered;  // [slot * actions + next action]
    repeat(settled_informed, entries_ * actions, 1, [&] {
      double change = 0;
      for (const std::uint32_t state : states_) {
        for (std::size_t action = 0; action < actions; ++action) {
          const std::size_t row = model_.row(state, action);
          seen.clear();
          gathered.clear();
          for (const auto* outcome = model_.outcomes.begin(row); outcome != model_.outcomes.end(row); ++outcome) {
            const double* next = values.data() + model_.row(outcome->next, 0);
            const auto* last = model_.readings.end(outcome->sensing);
            for (const auto* reading = model_.readings.begin(outcome->sensing); reading != last; ++reading) {
              std::size_t& slot = slot_of[reading->observation];
              if (slot >= seen.size() || seen[slot] != reading->observation) {
                slot = seen.size();
                seen.push_back(reading->observation);
                gathered.resize(seen.size() * actions, 0.0);
              }
              double* sum = gathered.data() + slot * actions;
              const double weight = outcome->probability * reading->probability;
              for (std::size_t i = 0; i < actions; ++i) sum[i] += weight * next[i];
            }
          }
          double later = 0;
          for (std::size_t slot = 0; slot < seen.size(); ++slot) {
            const auto first = gathered.begin() + static_cast<std::ptrdiff_t>(slot * actions);
            later += *std::max_element(first, first + static_cast<std::ptrdiff_t>(actions));
          }
          const double tighter = model_.rewards[row] + model_.discount * later;
          change = std::max(change, values[row] - tighter);
          values[row] = std::min(values[row], tighter);
        }
      }
      return change;
    });
  }

  const FlatModel& model_;
  const Regions& regions_;
  std::vector<std::uint32_t> states_;
  std::size_t entries_ = 0;
  double highest_ = 0;
  double scale_ = 0;
};

}  // namespace aos::point_based
