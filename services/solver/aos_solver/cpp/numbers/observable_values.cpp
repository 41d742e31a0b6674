#include "numbers/observable_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aos/base/progress.hpp"

namespace aos {

MoreValues one_more_decision(const point_based::FlatModel& rows, const List<double>& later, List<double>& values,
                             List<float>* action_values) {
  MoreValues more{0, -std::numeric_limits<double>::infinity()};
  for (std::size_t state = 0; state < rows.states; ++state) {
    double best = -std::numeric_limits<double>::infinity();
    for (std::size_t action = 0; action < rows.actions; ++action) {
      const std::size_t row = rows.row(state, action);
      const double value = backed_up(rows, row, later);
      if (action_values != nullptr) (*action_values)[row] = static_cast<float>(value);
      best = std::max(best, value);
    }
    values[state] = best;
    more.highest = std::max(more.highest, best);
    more.change = std::max(more.change, std::abs(best - later[state]));
  }
  return more;
}

void ObservableValues::prepare(const point_based::FlatModel& rows, point_based::Numbering numbering, int horizon) {
  constexpr std::size_t max_values = 4'000'000;
  if (numbering_ != numbering) layers_.clear();
  numbering_ = numbering;
  if (states() * static_cast<std::size_t>(horizon) > max_values) return layers_.clear();
  if (layers_.empty()) layers_.emplace_back(states(), 0.0);
  for (auto left = static_cast<int>(layers_.size()); left < horizon; ++left) {
    progress::tell("computing values of states", left, horizon);
    List<double> values(states(), std::numeric_limits<double>::infinity());
    one_more_decision(rows, layers_.back(), values);
    layers_.push_back(std::move(values));
  }
}

}
