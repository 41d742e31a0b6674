// Plans that repeat one action whatever is observed: the alpha vectors that are there before any trial, and what they
// add at the end of another plan.
#pragma once

#include "point_based/bounds.hpp"
#include "point_based/initial_bounds.hpp"
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

// The lower bound of a region by the plans that repeat one action, without those that give nothing more.
inline LowerBound blind_bound(const FlatModel& model, const Region& region, const List<ActionValues>& blind,
                              const Tails& tails) {
  const bool is_endless = model.horizon == 0;
  LowerBound lower;
  List<AlphaVector> vectors;
  for (std::uint32_t action = 0; action < model.actions; ++action) {
    const std::size_t first = vectors.size();
    for (std::uint32_t left = is_endless ? 0 : 1; left < blind.size(); ++left) {
      List<double> values;
      for (const std::uint32_t state : region.states) values.push_back(blind[left][model.row(state, action)]);
      if (vectors.size() > first) {  // longer plans only where they give more
        const AlphaVector& before = vectors.back();
        const double worth_it = tails.of(before.length, left) + 1e-9 * before.size;
        const auto gives_no_more = [&](double value, double known) { return value <= known + worth_it; };
        if (std::equal(values.begin(), values.end(), before.values.begin(), gives_no_more)) continue;
      }
      vectors.emplace_back(action, left, std::move(values));
    }
  }
  if (is_endless) {  // one of each action
    for (std::size_t i = vectors.size(); i-- > 0;) {
      for (std::size_t j = 0; j < vectors.size(); ++j) {
        if (i == j || !is_nowhere_above(vectors[i].values, vectors[j].values)) continue;
        vectors.erase(vectors.begin() + static_cast<std::ptrdiff_t>(i));
        break;
      }
    }
  }
  for (AlphaVector& vector : vectors) lower.add_blind(std::move(vector));
  return lower;
}

}
