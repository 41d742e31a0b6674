// Certainty-equivalent plans: such a plan does what has the highest fully observable value in the state that it assumes, and then
// assumes the state that is likeliest after the observation. Their values, for every pair of an assumed and a true state, are
// initial alpha vectors. Where a belief is nearly certain, they are far above those that repeat one action, so that a search need
// not look beyond the point where the robot knows enough. They serve missions without end only.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "point_based/bounds.hpp"
#include "point_based/initial_bounds.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

class CertaintyEquivalent {
 public:
  // `informed` are upper bounds of action values. The plans choose their actions by these.
  CertaintyEquivalent(const FlatModel& model, const Regions& regions, const ActionValues& informed, double rounding)
      : model_(model), regions_(regions), informed_(informed), rounding_(rounding) {
    if (!is_small()) return;
    for (const double reward : model.rewards) {
      lowest_ = std::min(lowest_, reward);
      scale_ = std::max(scale_, std::abs(reward));
    }
    const double worst = lowest_ / (1 - model.discount) * (1 + 1e-9);
    for (const Region& region : regions_.all) {
      first_of_.push_back(values_.size());
      values_.resize(values_.size() + region.states.size() * region.states.size(), worst);
    }
    for (std::uint32_t number = 0; number < regions_.all.size(); ++number) add_steps(number);
    for (int sweep = 0; sweep < max_sweeps_ && renew() > settled_ * scale_; ++sweep) {}
  }

  // One vector for each assumed state of a region; none if the model is too large.
  std::vector<AlphaVector> vectors(std::uint32_t region) const {
    std::vector<AlphaVector> vectors;
    if (values_.empty()) return vectors;
    const std::size_t size = regions_.all[region].states.size();
    for (std::uint32_t taken = 0; taken < size; ++taken) {
      const auto first = values_.begin() + static_cast<std::ptrdiff_t>(first_of_[region] + taken * size);
      vectors.emplace_back(best_action(region, taken), 0u, std::vector<double>(first, first + static_cast<std::ptrdiff_t>(size)));
    }
    return vectors;
  }

 private:
  static constexpr std::size_t max_states_of_region_ = 200;
  static constexpr std::size_t max_pairs_ = 100'000;
  static constexpr std::size_t max_landings_ = 20'000'000;  // successors of all pairs
  static constexpr int max_sweeps_ = 300;
  static constexpr double settled_ = 1e-5;

  // A pair of an assumed and a true state that may come next.
  struct Step {
    std::size_t pair;
    double probability;
  };

  bool is_small() const {
    std::size_t pairs = 0;
    std::size_t looked_at = 0;
    for (const Region& region : regions_.all) {
      const std::size_t size = region.states.size();
      if (size > max_states_of_region_ || (pairs += size * size) > max_pairs_) return false;
      std::size_t successors = 0;
      for (const Move& move : region.moves) {
        std::size_t of_move = 0;
        for (const ObservationBranch& observation_branch : move.observation_branches) of_move += observation_branch.successors.size();
        successors = std::max(successors, of_move);
      }
      if ((looked_at += size * successors) > max_landings_) return false;
    }
    return true;
  }

  std::uint32_t best_action(std::uint32_t region, std::uint32_t local) const {
    const double* first = informed_.data() + model_.row(regions_.all[region].states[local], 0);
    return static_cast<std::uint32_t>(std::max_element(first, first + model_.actions) - first);
  }

  void add_steps(std::uint32_t number) {
    const Region& region = regions_.all[number];
    for (std::uint32_t taken = 0; taken < region.states.size(); ++taken) {
      const Move& move = region.moves[best_action(number, taken)];
      find_landings(move, taken);
      for (std::uint32_t truth = 0; truth < region.states.size(); ++truth) {
        rewards_.push_back(move.rewards[truth]);
        first_step_.push_back(steps_.size());
        for (const auto& flow : move.flows[truth]) {
          for (const Step& step : of_target_[flow.target]) {
            add(steps_, first_step_.back(), {step.pair, flow.probability * step.probability});
          }
        }
      }
    }
    if (number + 1 == regions_.all.size()) first_step_.push_back(steps_.size());
  }
  // Adds to the step with the same pair, from `first` on, or appends a new step.
  static void add(std::vector<Step>& steps, std::size_t first, const Step& step) {
    const auto is_it = [&](const Step& known) { return known.pair == step.pair; };
    const auto known = std::find_if(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end(), is_it);
    if (known == steps.end()) {
      steps.push_back(step);
    } else {
      known->probability += step.probability;
    }
  }

  // Fills `of_target_` with the pairs of states that follow each target of a move if `taken` is assumed.
  void find_landings(const Move& move, std::uint32_t taken) {
    predicted_.assign(move.targets, 0.0);
    for (const auto& flow : move.flows[taken]) {
      predicted_[flow.target] += flow.probability;
    }
    of_target_.resize(std::max<std::size_t>(of_target_.size(), move.targets));
    for (std::size_t target = 0; target < move.targets; ++target) of_target_[target].clear();
    for (const ObservationBranch& observation_branch : move.observation_branches) {
      const std::size_t size = regions_.all[observation_branch.region].states.size();
      const std::size_t first = first_of_[observation_branch.region] + likeliest(observation_branch) * size;
      for (const ObservationBranch::Successor& successor : observation_branch.successors) {
        add(of_target_[successor.target], 0, {first + successor.local, successor.probability});
      }
    }
  }
  // The likeliest state after an observation. The observation alone decides if it rules out what was predicted.
  std::uint32_t likeliest(const ObservationBranch& observation_branch) const {
    double best = -1;
    std::uint32_t local = 0;
    for (const ObservationBranch::Successor& successor : observation_branch.successors) {
      const double weight = successor.probability * (predicted_[successor.target] + tiny_);
      if (weight <= best) continue;
      best = weight;
      local = successor.local;
    }
    return local;
  }

  // One sweep of value iteration. Values rise from below those of any plan to those of these plans. Each sum
  // is moved down by what rounding may have added. Returns the largest change.
  double renew() {
    double change = 0;
    for (std::size_t pair = 0; pair < values_.size(); ++pair) {
      double later = 0;
      double size = std::abs(rewards_[pair]);
      for (std::size_t i = first_step_[pair]; i < first_step_[pair + 1]; ++i) {
        const double part = steps_[i].probability * values_[steps_[i].pair];
        later += part;
        size += std::abs(part);
      }
      const double value = rewards_[pair] + model_.discount * later - 4 * rounding_ * size;
      change = std::max(change, value - values_[pair]);
      values_[pair] = std::max(values_[pair], value);
    }
    return change;
  }

  static constexpr double tiny_ = 1e-9;

  const FlatModel& model_;
  const Regions& regions_;
  const ActionValues& informed_;
  double rounding_;
  double lowest_ = 0;
  double scale_ = 0;
  std::vector<std::size_t> first_of_;  // the first pair of each region
  std::vector<double> values_;         // by pair
  std::vector<double> rewards_;
  std::vector<std::size_t> first_step_;
  std::vector<Step> steps_;
  std::vector<double> predicted_;
  std::vector<std::vector<Step>> of_target_;
};

}
