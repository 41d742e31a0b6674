// Without a discount it makes no difference when something is earned, and a free exit could be put off for ever. So
// the search has a discount next to 1, which tells sooner from later, and what that changes is added to its bounds.
#pragma once

#include <algorithm>
#include <vector>

#include "point_based/flat_model.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

class Haste {
 public:
  // Sets the model's discount to the one to search with.
  explicit Haste(FlatModel& model) {
    if (model.horizon == 0) return;
    const double loss = loss_of_all_ / static_cast<double>(model.horizon);
    if (model.discount <= 1 - loss) return;
    const double share = 1 - (1 - loss) / model.discount + ulp;
    add_errors(model, share);
    model.discount = 1 - loss;
  }

  // Values with the discount of the model are less than so much above and below those with the other.
  double above() const { return above_; }
  double below() const { return below_; }

 private:
  static constexpr double loss_of_all_ = 1e-7;  // by which the last reward counts less

  // A reward after t decisions loses at most `share` of itself t times. Summed over t these are values of what is left of
  // a mission after one decision, two, and so on: no more than the most that any state is worth then.
  void add_errors(const FlatModel& model, double share) {
    std::vector<double> best(model.states, 0.0), worst(model.states, 0.0), now(model.states);
    for (std::size_t left = 1; left < model.horizon; ++left) {
      above_ += renew<true>(model, best, now);
      below_ += renew<false>(model, worst, now);
    }
    const double rounded_up = share * (1 + 1e-6);
    above_ *= rounded_up;
    below_ *= rounded_up;
  }

  // One more decision for the best, or the worst, of all plans of somebody who sees the state. Returns the furthest value
  // on that side of 0.
  template <bool is_best>
  static double renew(const FlatModel& model, std::vector<double>& values, std::vector<double>& now) {
    double furthest = 0;
    for (std::size_t state = 0; state < model.states; ++state) {
      for (std::size_t action = 0; action < model.actions; ++action) {
        const std::size_t row = model.row(state, action);
        double later = 0;
        for (const auto* outcome = model.outcomes.begin(row); outcome != model.outcomes.end(row); ++outcome) {
          later += outcome->probability * values[outcome->next];
        }
        const double value = model.rewards[row] + model.discount * later;
        if (action == 0 || (is_best ? value > now[state] : value < now[state])) now[state] = value;
      }
      furthest = std::max(furthest, is_best ? now[state] : -now[state]);
    }
    values.swap(now);
    return furthest;
  }

  double above_ = 0;
  double below_ = 0;
};

}  // namespace aos::point_based
