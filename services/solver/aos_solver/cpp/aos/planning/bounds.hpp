// What a state is worth to somebody who sees it, for models of up to some hundred thousand states: what planners count
// values from, an upper bound of them, and the actions that DESPOT's default policy prefers.
//
// Values are of the underlying MDP by value iteration, for each number of decisions to go until they no longer change,
// or only for the most where there is no room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "aos/belief/belief.hpp"
#include "aos/planning/relevant_states.hpp"

namespace aos {

inline constexpr std::size_t most_layered_values = 8'000'000;
inline constexpr double settled_share = 1e-4;  // of the largest value

template <class Model>
class SeenValues {
 public:
  using State = typename Model::State;

  // Prepares values for up to `horizon` decisions. Returns whether the model is small enough; the limits are in states
  // and outcomes, not in time, so that decisions can be repeated. Does little for a belief whose states are known.
  bool prepare(const Belief<Model>& belief, int horizon) {
    if (is_too_large_ || Model::action_count() == 0) return false;
    const std::size_t known = states_.size();
    try {
      states_.reach_from(belief);
    } catch (const NotEnumerable&) {
      is_too_large_ = true;
      states_ = {};
      return false;
    }
    if (known == states_.size() && horizon == horizon_) return true;
    horizon_ = horizon;
    ++iterations_;
    iterate();
    return true;
  }

  std::size_t states() const { return states_.size(); }
  // How often values were worked out anew, and with them perhaps the numbers of states.
  std::uint64_t iterations() const { return iterations_; }

  // Of a state; `RelevantStates::none` for one that was not reckoned with, which is worth the most.
  std::uint32_t number_of(const State& state) const { return states_.find(state); }

  // Where an action leads from a state if that is certain and no end; else `RelevantStates::none`.
  std::uint32_t certain_next(std::uint32_t number, int action) const {
    if (number == RelevantStates<Model>::none) return number;
    const std::size_t pair = number * actions() + static_cast<std::size_t>(action);
    const std::size_t first = pair == 0 ? 0 : states_.branch_ends()[pair - 1];
    if (states_.branch_ends()[pair] != first + 1) return RelevantStates<Model>::none;
    const auto [next, probability] = states_.branches()[first];
    return probability > 1 - 1e-6f ? next : RelevantStates<Model>::none;
  }

  // With `horizon` decisions to go.
  double value(std::uint32_t number, int horizon) const {
    return number == RelevantStates<Model>::none ? highest_ : layer(horizon)[number];
  }

  // What an action costs somebody who sees the state, against the best one: how much less it is worth, so never above 0.
  double advantage(std::uint32_t number, int action, int horizon) const {
    if (number == RelevantStates<Model>::none) return 0;
    const std::size_t pair = number * actions() + static_cast<std::size_t>(action);
    const std::vector<double>& later = layer(horizon - 1);
    double continuation = 0;
    const std::size_t first = pair == 0 ? 0 : states_.branch_ends()[pair - 1];
    for (std::size_t branch = first; branch < states_.branch_ends()[pair]; ++branch) {
      const auto [next, probability] = states_.branches()[branch];
      continuation += probability * later[next];
    }
    const double worth = states_.rewards()[pair] + Model::discount * continuation;
    return std::min(worth - layer(horizon)[number], 0.0);
  }

  // Adds what each action is worth with many decisions to go.
  void add_action_values(std::uint32_t number, std::vector<double>& sums) const {
    if (number == RelevantStates<Model>::none) return;
    const float* values = &action_values_[number * actions()];
    for (std::size_t action = 0; action < actions(); ++action) sums[action] += values[action];
  }

 private:
  static std::size_t actions() { return static_cast<std::size_t>(Model::action_count()); }

  void iterate() {
    layers_.assign(1, std::vector<double>(states_.size()));
    action_values_.assign(states_.size() * actions(), 0);
    const bool has_room = states_.size() * (static_cast<std::size_t>(horizon_) + 1) <= most_layered_values;
    for (int decisions = 1; decisions <= horizon_; ++decisions) {
      std::vector<double> values(states_.size());
      const double change = one_more_decision(layers_.back(), values);
      if (!has_room) layers_.clear();
      layers_.push_back(std::move(values));
      if (change <= settled_share * std::abs(highest_)) break;
    }
  }

  // Returns the largest change.
  double one_more_decision(const std::vector<double>& later, std::vector<double>& values) {
    constexpr double lowest = -std::numeric_limits<double>::infinity();
    double change = 0;
    highest_ = lowest;
    std::size_t branch = 0;
    for (std::size_t number = 0; number < states_.size(); ++number) {
      double best = lowest;
      for (std::size_t pair = number * actions(); pair < (number + 1) * actions(); ++pair) {
        double continuation = 0;
        for (; branch < states_.branch_ends()[pair]; ++branch) {
          const auto [next, probability] = states_.branches()[branch];
          continuation += probability * later[next];
        }
        const double value = states_.rewards()[pair] + Model::discount * continuation;
        action_values_[pair] = static_cast<float>(value);
        best = std::max(best, value);
      }
      values[number] = best;
      highest_ = std::max(highest_, best);
      change = std::max(change, std::abs(best - later[number]));
    }
    return change;
  }

  const std::vector<double>& layer(int horizon) const {
    return layers_[std::min(static_cast<std::size_t>(std::max(horizon, 0)), layers_.size() - 1)];
  }

  bool is_too_large_ = false;
  int horizon_ = 0;
  std::uint64_t iterations_ = 0;
  double highest_ = 0;
  RelevantStates<Model> states_;
  std::vector<std::vector<double>> layers_;
  std::vector<float> action_values_;
};

}  // namespace aos
