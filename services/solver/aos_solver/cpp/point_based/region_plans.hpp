// Plans that know the region only: a region has an action for each number of decisions that are left. Where a counter is seen, a
// plan repeats one action for a hundred steps and then takes another one; where a place is seen, it goes somewhere first. Trials
// that follow one observation of many have these plans for all others.
#pragma once

#include "point_based/initial_bounds.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

// A lower bound of each state's value, and the action that the plan begins with in each region.
struct RegionPlan {
  List<std::uint32_t> actions;
  List<double> values;
};

class RegionPlans {
 public:
  // `blind` are lower bounds of repeated actions, by layer.
  RegionPlans(const FlatModel& model, const Regions& regions, const List<ActionValues>& blind, double rounding)
      : model_(model), regions_(regions), rounding_(rounding) {
    const RegionPlan none{List<std::uint32_t>(regions.all.size(), 0), List<double>(model.states, 0.0)};
    if (model.horizon == 0) {
      by_layer_.push_back(none);
      for (std::uint32_t region = 0; region < regions.all.size(); ++region) repeat(region, blind.front(), by_layer_.front());
      lengthen(by_layer_.front());
      return;
    }
    by_layer_.push_back(none);
    for (std::size_t left = 1; left <= model.horizon; ++left) {
      RegionPlan plan = none;
      for (std::uint32_t region = 0; region < regions.all.size(); ++region) {
        const double repeated = repeat(region, blind[left], plan);
        put_before(region, by_layer_.back().values, repeated, plan);
      }
      by_layer_.push_back(std::move(plan));
    }
  }

  // By layer: the number of decisions that are left, or 0 without a horizon.
  const List<RegionPlan>& by_layer() const { return by_layer_; }

 private:
  static constexpr double operations_ = 1e7;
  static constexpr double max_sweeps_ = 300;

  // Actions are compared by the sums over all states of the region, since nothing more is known.
  double sum_of(std::uint32_t region, const List<double>& values) const {
    double sum = 0;
    for (const std::uint32_t state : regions_.all[region].states) sum += values[state];
    return sum;
  }

  // Sets the best action that is repeated from a region on. Returns the sum of its values.
  double repeat(std::uint32_t region, const ActionValues& blind, RegionPlan& plan) const {
    const List<std::uint32_t>& states = regions_.all[region].states;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      double sum = 0;
      for (const std::uint32_t state : states) sum += blind[model_.row(state, action)];
      if (sum <= highest) continue;
      highest = sum;
      plan.actions[region] = action;
    }
    for (const std::uint32_t state : states) plan.values[state] = blind[model_.row(state, plan.actions[region])];
    return highest;
  }

  // Puts the best action before a plan of which each state's value is known, if the sum of its values then exceeds `sum`. Returns by how much.
  double put_before(std::uint32_t region, const List<double>& later, double sum, RegionPlan& plan) const {
    const List<std::uint32_t>& states = regions_.all[region].states;
    double highest = sum;
    List<double> best, values(states.size());
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      double all = 0;
      for (std::size_t i = 0; i < states.size(); ++i) all += values[i] = least(model_.row(states[i], action), later);
      if (all <= highest) continue;
      highest = all;
      best = values;
      plan.actions[region] = action;
    }
    for (std::size_t i = 0; i < best.size(); ++i) plan.values[states[i]] = best[i];
    return highest - sum;
  }

  // The value of a row if what follows has these values, moved down by the rounding.
  double least(std::size_t row, const List<double>& later) const {
    double sum = 0, size = 0;
    for (const Outcome& outcome : model_.outcomes[row]) {
      const double part = outcome.probability * later[outcome.next];
      sum += part;
      size += std::abs(part);
    }
    return model_.rewards[row] + model_.discount * sum - rounding_ * (std::abs(model_.rewards[row]) + size);
  }

  // Without a horizon each sweep puts an action before the plans of all regions where this gains, for as long as it does.
  void lengthen(RegionPlan& plan) const {
    const double sweeps = std::clamp(operations_ / static_cast<double>(model_.outcomes.elements.size() + 1), 1.0, max_sweeps_);
    bool gains = true;
    for (double done = 0; done < sweeps && gains; ++done) {
      gains = false;
      for (std::uint32_t region = 0; region < regions_.all.size(); ++region) {
        const double sum = sum_of(region, plan.values);
        if (put_before(region, plan.values, sum, plan) > 1e-6 * std::abs(sum)) gains = true;
      }
    }
  }

  const FlatModel& model_;
  const Regions& regions_;
  double rounding_;
  List<RegionPlan> by_layer_;
};

}
