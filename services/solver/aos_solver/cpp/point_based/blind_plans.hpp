// Plans that look at nothing but the region: the alpha vectors that are there before any trial, and what those that repeat one
// action add at the end of another plan.
#pragma once

#include "point_based/bounds.hpp"
#include "point_based/initial_bounds.hpp"
#include "point_based/region_plans.hpp"
#include "point_based/regions.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

// What repeating one action gives at least, wherever a plan has ended. `blind` has the values of always the same action,
// by the number of decisions.
class Tails {
 public:
  Tails() = default;
  Tails(const FlatModel& model, const List<ActionValues>& blind) {
    double power = 1;
    for (const ActionValues& values : blind) {
      min_value_ = -std::numeric_limits<double>::infinity();
      for (std::size_t action = 0; action < model.actions; ++action) {
        double lowest = 0;
        for (std::size_t state = 0; state < model.states; ++state) lowest = std::min(lowest, values[model.row(state, action)]);
        min_value_ = std::max(min_value_, lowest);
      }
      tails_.push_back(model.horizon == 0 ? 0 : min_value_);
      if (tails_.back() < 0) are_free_ = false;
      powers_.push_back(power);
      power *= model.discount * (1 + 2 * ulp);
    }
  }

  // A lower bound of what a plan of `length` decisions gains when it is continued to `left` decisions.
  double of(std::uint32_t length, std::uint32_t left) const {
    return powers_[length] * tails_[left - length] * (1 + 8 * ulp);
  }
  // Whether longer plans are worth no less than shorter ones, since some action costs nothing in any state.
  bool are_free() const { return are_free_; }
  // Some policy gives at least this from every state on. At most 0.
  double min_value() const { return min_value_; }

 private:
  List<double> tails_;   // by decisions
  List<double> powers_;  // of the discount
  bool are_free_ = true;
  double min_value_ = 0;
};

inline bool is_nowhere_above(const List<double>& values, const List<double>& others) {
  return std::equal(values.begin(), values.end(), others.begin(), std::less_equal<>{});
}

// The vectors of a plan in the order of their lengths, without longer ones that give nothing more. `values_of` has the values with so
// many decisions left, by state.
List<AlphaVector> vectors_of(std::size_t layers, const Tails& tails, auto&& action_of, auto&& values_of) {
  List<AlphaVector> vectors;
  for (std::uint32_t left = layers == 1 ? 0 : 1; left < layers; ++left) {
    List<double> values = values_of(left);
    if (!vectors.empty()) {
      const AlphaVector& before = vectors.back();
      const double worth_it = tails.of(before.length, left) + 1e-9 * before.size;
      const auto gives_no_more = [&](double value, double known) { return value <= known + worth_it; };
      if (std::equal(values.begin(), values.end(), before.values.begin(), gives_no_more)) continue;
    }
    vectors.emplace_back(action_of(left), left, std::move(values));
  }
  return vectors;
}

// The lower bound of a region by the plans that repeat one action, and by the one that knows regions. Without a horizon those that
// give nothing more are left out.
inline LowerBound blind_bound(const FlatModel& model, std::uint32_t number, const Region& region, const List<ActionValues>& blind,
                              const List<RegionPlan>& region_plans, const Tails& tails) {
  List<List<AlphaVector>> plans;
  const auto by_state = [&](auto&& value_of) {
    List<double> values;
    for (const std::uint32_t state : region.states) values.push_back(value_of(state));
    return values;
  };
  for (std::uint32_t action = 0; action < model.actions; ++action) {
    plans.push_back(vectors_of(blind.size(), tails, [&](std::uint32_t) { return action; }, [&](std::uint32_t left) {
      return by_state([&](std::uint32_t state) { return blind[left][model.row(state, action)]; });
    }));
  }
  if (!region_plans.empty()) {
    plans.push_back(vectors_of(blind.size(), tails, [&](std::uint32_t left) { return region_plans[left].actions[number]; }, [&](std::uint32_t left) {
      return by_state([&](std::uint32_t state) { return region_plans[left].values[state]; });
    }));
  }
  if (model.horizon == 0) {
    for (std::size_t i = plans.size(); i-- > 0;) {
      for (std::size_t j = 0; j < plans.size(); ++j) {
        if (i == j || !is_nowhere_above(plans[i].front().values, plans[j].front().values)) continue;
        plans.erase(plans.begin() + static_cast<std::ptrdiff_t>(i));
        break;
      }
    }
  }
  LowerBound lower;
  for (List<AlphaVector>& plan : plans) lower.add_blind(std::move(plan));
  return lower;
}

}
