// The fully observable (MDP) values of states, for models of up to some hundred thousand states. Planners use
// them as an origin of values and as upper bounds. DESPOT's default policy chooses actions by them.
//
// Value iteration gives a layer for each number of decisions to go, until the values no longer change. If
// there is no room for all layers, only the last one is kept.
#pragma once

#include "aos/base/progress.hpp"
#include "aos/base/statistics.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/values/state_values.hpp"
#include "aos/planning/values/value_constants.hpp"
#include "numbers/observable_values.hpp"
#include "point_based/rounding.hpp"

namespace aos {

template <class Model>
class MdpValues final : public StateValues<Model> {
 public:
  using State = typename Model::State;

  explicit MdpValues(StateSpace<Model>& space) : space_(space) {}

  // Prepares values for up to `horizon` decisions. Returns whether the model is small enough. A belief whose
  // states are known takes little time.
  bool prepare(const Belief<Model>& belief, int horizon) {
    is_prepared_ = Model::action_count() > 0 && space_.reach(belief);
    if (!is_prepared_) return false;
    if (values_of_ == space_.numbering() && horizon == horizon_) return true;
    values_of_ = space_.numbering();
    horizon_ = horizon;
    iterate();
    return true;
  }

  // Whether the last `prepare` was for the states that are listed now, and for this horizon.
  bool knows(int horizon) const { return values_of_ == space_.numbering() && horizon == horizon_ && is_prepared_; }

  const StateSpace<Model>& space() const { return space_; }

  // The number of a state; `no_state` if the state is not listed. Such a state has the highest value.
  std::uint32_t number_of(const State& state) const { return space_.find(state); }

  // The next state after an action if it is certain and has not ended; else `no_state`.
  std::uint32_t certain_next(std::uint32_t number, int action) const {
    if (number == no_state) return number;
    const std::size_t row = rows().row(number, action);
    const auto outcomes = rows().outcomes[row];
    return outcomes.size() == 1 && outcomes[0].probability > 1 - 1e-6 ? outcomes[0].next : no_state;
  }

  double value(const State& state, int left) const override { return value(number_of(state), left); }
  // The value with `horizon` decisions to go.
  [[gnu::always_inline]] double value(std::uint32_t number, int horizon) const {
    return number == no_state ? highest_ : layer(horizon)[number];
  }

  void advantages(const State& state, double* worths, Sampler& /*random*/) const override { advantages(number_of(state), worths); }
  void advantages(std::uint32_t number, double* worths) const {
    for (std::size_t action = 0; action < actions(); ++action) worths[action] = advantage(number, action, horizon_);
  }

  // The fully observable value of an action less that of the best action; never above 0.
  double advantage(std::uint32_t number, int action, int horizon) const {
    if (number == no_state) return 0;
    const double worth = value_of(rows().row(number, action), layer(horizon - 1));
    return std::min(worth - layer(horizon)[number], 0.0);
  }

  // The value of an action with `horizon` decisions to go, where the state after it is seen.
  double action_value(std::uint32_t number, std::size_t action, int horizon) const {
    const std::size_t row = rows().row(number, action);
    const bool is_last = static_cast<std::size_t>(horizon) + 1 >= layers_.size();
    return is_last ? action_values_[row] : value_of(row, layer(horizon - 1));
  }

  // The most that each action may return from listed states with these weights, with the whole horizon to go: proven,
  // since no robot sees more than the state.
  List<double> at_most(const List<std::pair<std::uint32_t, double>>& weights) const {
    List<double> most(actions());
    const List<double>& later = layer(horizon_ - 1);
    for (std::size_t action = 0; action < actions(); ++action) {
      for (const auto& [number, weight] : weights) most[action] += weight * value_of(rows().row(number, action), later);
      most[action] += error_;
    }
    return most;
  }

  // Adds the value of each action with many decisions to go, times a weight.
  void add_action_values(std::uint32_t number, List<double>& sums, double weight = 1) const {
    if (number == no_state) return;
    const float* values = &action_values_[number * actions()];
    for (std::size_t action = 0; action < actions(); ++action) sums[action] += weight * values[action];
  }

 private:
  const point_based::FlatModel& rows() const { return space_.rows(); }
  std::size_t actions() const { return space_.actions(); }

  void iterate() {
    layers_.assign(1, List<double>(space_.size()));
    action_values_.assign(space_.size() * actions(), 0);
    const bool has_room = space_.size() * (static_cast<std::size_t>(horizon_) + 1) <= max_layered_values;
    double change = 0;
    int decisions = 0;
    while (decisions < horizon_) {
      progress::tell("computing values of states", decisions, horizon_);
      List<double> values(space_.size());
      const MoreValues more = one_more_decision(rows(), layers_.back(), values, &action_values_);
      change = more.change;
      highest_ = more.highest;
      if (!has_room) layers_.clear();
      layers_.push_back(std::move(values));
      ++decisions;
      if (change <= settled_share * std::abs(highest_)) break;
    }
    error_ = rounding() + (has_room && decisions >= horizon_ - 1 ? 0 : change * changes_beyond(decisions));
  }

  // How often the last change may come again, discounted, until all decisions but one are counted. A layer that stands
  // for the one before it is off by one change.
  double changes_beyond(int decisions) const {
    double sum = 0;
    double discount = 1;
    for (int i = decisions + 1; i < horizon_; ++i) sum += discount *= Model::discount;
    return std::max(sum, 1.0);
  }
  // How far rounding may move the mean value of an action, at most.
  double rounding() const {
    const double decisions = horizon_;
    const double once = point_based::rounding_of(point_based::longest_row(rows().outcomes) + space_.size());
    return 2 * once * decisions * decisions * largest_size(rows().rewards);
  }

  double value_of(std::size_t row, const List<double>& later) const { return backed_up(rows(), row, later); }

  [[gnu::always_inline]] const List<double>& layer(int horizon) const {
    return layers_[std::min(static_cast<std::size_t>(std::max(horizon, 0)), layers_.size() - 1)];
  }

  StateSpace<Model>& space_;
  Numbering values_of_;
  int horizon_ = 0;
  bool is_prepared_ = false;  // by the last belief
  double highest_ = 0;
  double error_ = 0;  // of values with the whole horizon to go, at most
  List<List<double>> layers_;
  List<float> action_values_;
};

}
