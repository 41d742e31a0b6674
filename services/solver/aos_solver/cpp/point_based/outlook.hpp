// The horizon and the discount of a search, and how far they move values from those of the model.
//
// Without a discount a search gets one slightly below 1, since a free exit could else be put off for ever. If the discount leaves
// next to nothing of what comes after a long horizon, it has no horizon, so that its results serve every belief, however many
// decisions are left, and bounds are widened by what may come after the horizon.
#pragma once

#include <cmath>

#include "point_based/flat_model.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

class Outlook {
 public:
  // Sets the model's horizon and discount to those of the search.
  explicit Outlook(FlatModel& model) {
    if (model.horizon == 0) return;
    left_behind_ = std::pow(model.discount, static_cast<double>(model.horizon)) * (1 + 1e-9);
    if (left_behind_ <= next_to_nothing_) {
      model.horizon = 0;
      return;
    }
    left_behind_ = 0;
    const double loss = loss_of_all_ / static_cast<double>(model.horizon);
    if (model.discount <= 1 - loss) return;
    const double share = 1 - (1 - loss) / model.discount + ulp;
    add_errors(model, share);
    model.discount = 1 - loss;
  }

  // How far the model's values may be above and below those of the search. No state is worth more than
  // `max_value`, and some policy never gives less than `min_value`, which is at most 0.
  double above(double min_value) const { return above_ - left_behind_ * min_value; }
  double below(double max_value) const { return below_ + left_behind_ * max_value; }

 private:
  static constexpr double next_to_nothing_ = 0.01;
  static constexpr double loss_of_all_ = 1e-7;  // the share that the last reward loses

  // A reward after t decisions loses its `share` at most t times. The sum of the losses is `share` times the values of
  // what is left after one decision, after two, and so on. Each value is at most that of the best state then.
  void add_errors(const FlatModel& model, double share) {
    List<double> best(model.states, 0.0), worst(model.states, 0.0), now(model.states);
    for (std::size_t left = 1; left < model.horizon; ++left) {
      above_ += renew<true>(model, best, now);
      below_ += renew<false>(model, worst, now);
    }
    const double rounded_up = share * (1 + 1e-6);
    above_ *= rounded_up;
    below_ *= rounded_up;
  }

  // Extends the best, or the worst, fully observable value of each state by one decision. Returns the largest
  // size of a value on that side of 0.
  template <bool is_best>
  static double renew(const FlatModel& model, List<double>& values, List<double>& now) {
    double furthest = 0;
    for (std::size_t state = 0; state < model.states; ++state) {
      for (std::size_t action = 0; action < model.actions; ++action) {
        const std::size_t row = model.row(state, action);
        const double value = model.rewards[row] + model.discount * model.later_value(row, values);
        if (action == 0 || (is_best ? value > now[state] : value < now[state])) now[state] = value;
      }
      furthest = std::max(furthest, is_best ? now[state] : -now[state]);
    }
    values.swap(now);
    return furthest;
  }

  double above_ = 0;
  double below_ = 0;
  double left_behind_ = 0;  // the share that the discount leaves of what comes after the horizon
};

}
