// Certainty-equivalent plans: such a plan does what has the highest fully observable value in the state that it assumes, and then
// assumes the state that is likeliest after the observation. Their values, for every pair of an assumed and a true state, are
// initial alpha vectors. Where a belief is nearly certain, they are far above those that repeat one action, so that a search need
// not look beyond the point where the robot knows enough. Where an observation rules out what was assumed, the next of the states
// that are as likely is assumed, so that a plan tries them all. A plan that leads to one of the largest regions repeats an action
// there. They serve missions without end only.
#pragma once

#include <map>

#include "aos/base/statistics.hpp"
#include "point_based/bounds.hpp"
#include "point_based/initial_bounds.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

class CertaintyEquivalent {
 public:
  // `informed` are upper bounds of action values, by which the plans choose their actions; `blind` are lower ones of repeated actions.
  CertaintyEquivalent(const FlatModel& model, const Regions& regions, const ActionValues& informed, const ActionValues& blind,
                      double rounding)
      : model_(model), regions_(regions), informed_(informed), blind_(blind), rounding_(rounding), largest_(largest_planned_size()) {
    if (largest_ == 0) return;
    for (const double reward : model.rewards) lowest_ = std::min(lowest_, reward);
    scale_ = largest_size(model.rewards);
    const double worst = lowest_ / (1 - model.discount) * (1 + 1e-9);
    for (const Region& region : regions_.all) {
      first_of_.push_back(values_.size());
      if (is_planned(region)) values_.resize(values_.size() + region.states.size() * region.states.size(), worst);
    }
    for (std::uint32_t number = 0; number < regions_.all.size(); ++number) {
      const Region& region = regions_.all[number];
      if (!is_planned(region)) continue;
      for (std::uint32_t taken = 0; taken < region.states.size(); ++taken) {
        const Move& move = region.moves[best_action(number, taken)];
        plans_.push_back({&move, plan_for(number, taken), first_landing_.size()});
        add_landings(move, taken);
      }
    }
    first_landing_.push_back(landings_.size());
    for (int sweep = 0; sweep < max_sweeps_ && renew() > settled_ * scale_; ++sweep) {}
  }

  // One vector for each assumed state of a region; none if the region is too large.
  List<AlphaVector> vectors(std::uint32_t region) const {
    List<AlphaVector> vectors;
    if (!is_planned(regions_.all[region])) return vectors;
    const std::size_t size = regions_.all[region].states.size();
    for (std::uint32_t taken = 0; taken < size; ++taken) {
      const auto first = values_.begin() + static_cast<std::ptrdiff_t>(first_of_[region] + taken * size);
      vectors.emplace_back(best_action(region, taken), 0u, List<double>(first, first + static_cast<std::ptrdiff_t>(size)));
    }
    return vectors;
  }

 private:
  static constexpr std::size_t max_pairs_ = 100'000;
  static constexpr int max_sweeps_ = 300;
  static constexpr double settled_ = 1e-5;

  // What is done in a region where a state is assumed.
  struct Plan {
    const Move* move;
    std::size_t pair;    // the first one, with each true state
    std::size_t target;  // the move's first one among the targets of all plans
  };
  // A pair of an assumed and a true state that may follow a target, or of an action that is repeated and a state.
  struct Landing {
    std::size_t pair;
    double probability;
  };

  // The size of a region up to which all regions have `max_pairs_` pairs of states at most.
  std::size_t largest_planned_size() const {
    List<std::size_t> sizes;
    for (const Region& region : regions_.all) sizes.push_back(region.states.size());
    std::sort(sizes.begin(), sizes.end());
    std::size_t largest = 0, pairs = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      if ((pairs += sizes[i] * sizes[i]) > max_pairs_) break;
      if (i + 1 == sizes.size() || sizes[i + 1] > sizes[i]) largest = sizes[i];
    }
    return largest;
  }
  bool is_planned(const Region& region) const { return region.states.size() <= largest_; }

  std::uint32_t best_action(std::uint32_t region, std::uint32_t local) const {
    const auto values = model_.of_actions(informed_, regions_.all[region].states[local]);
    return static_cast<std::uint32_t>(std::ranges::max_element(values) - values.begin());
  }

  // Adds the pairs that follow each target of a move if `taken` is assumed.
  void add_landings(const Move& move, std::uint32_t taken) {
    predicted_.assign(move.targets, 0.0);
    for (const auto& flow : move.flows[taken]) predicted_[flow.target] += flow.probability;
    of_target_.resize(std::max<std::size_t>(of_target_.size(), move.targets));
    for (const ObservationBranch& observation_branch : move.observation_branches) {
      const std::size_t first = plan_for(observation_branch.region, likeliest(observation_branch, taken));
      for (const ObservationBranch::Successor& successor : observation_branch.successors) {
        add(of_target_[successor.target], {first + successor.local, successor.probability});
      }
    }
    for (std::size_t target = 0; target < move.targets; ++target) {
      first_landing_.push_back(landings_.size());
      landings_.insert(landings_.end(), of_target_[target].begin(), of_target_[target].end());
      of_target_[target].clear();
    }
  }
  static void add(List<Landing>& landings, const Landing& landing) {
    const auto known = std::ranges::find(landings, landing.pair, &Landing::pair);
    if (known == landings.end()) landings.push_back(landing);
    else known->probability += landing.probability;
  }
  // The first pair of the plan that assumes a state in a region, or repeats the action that is best there.
  std::size_t plan_for(std::uint32_t number, std::uint32_t assumed) {
    const Region& region = regions_.all[number];
    if (is_planned(region)) return first_of_[number] + assumed * region.states.size();
    const std::uint32_t action = best_action(number, assumed);
    const auto [known, is_new] = repeated_.try_emplace({number, action}, values_.size());
    if (is_new) {
      for (const std::uint32_t state : region.states) values_.push_back(blind_[model_.row(state, action)]);
    }
    return known->second;
  }
  // The likeliest state after an observation, and of several the next after `taken`. The observation alone decides if it rules
  // out what was predicted.
  std::uint32_t likeliest(const ObservationBranch& observation_branch, std::uint32_t taken) const {
    double best = -1;
    std::uint32_t local = 0;
    for (const ObservationBranch::Successor& successor : observation_branch.successors) {
      const double weight = successor.probability * (predicted_[successor.target] + tiny_);
      if (weight < best || (weight == best && (local > taken || successor.local <= taken))) continue;
      best = weight;
      local = successor.local;
    }
    return local;
  }

  // One sweep of value iteration. Values rise from below those of any plan to those of these plans. Each sum
  // is moved down by what rounding may have added. Returns the largest change.
  [[gnu::optimize("O3")]] double renew() {
    double change = 0;
    for (const Plan& plan : plans_) {
      const Move& move = *plan.move;
      later_.assign(move.targets, {0, 0});
      for (std::size_t target = 0; target < move.targets; ++target) {
        auto& [later, size] = later_[target];
        for (std::size_t i = first_landing_[plan.target + target]; i < first_landing_[plan.target + target + 1]; ++i) {
          const double part = landings_[i].probability * values_[landings_[i].pair];
          later += part;
          size += std::abs(part);
        }
      }
      for (std::size_t truth = 0; truth < move.rewards.size(); ++truth) {
        double later = 0;
        double size = std::abs(move.rewards[truth]);
        for (const auto& flow : move.flows[truth]) {
          later += flow.probability * later_[flow.target].first;
          size += flow.probability * later_[flow.target].second;
        }
        const double value = move.rewards[truth] + model_.discount * later - 4 * rounding_ * size;
        double& known = values_[plan.pair + truth];
        change = std::max(change, value - known);
        known = std::max(known, value);
      }
    }
    return change;
  }

  static constexpr double tiny_ = 1e-9;

  const FlatModel& model_;
  const Regions& regions_;
  const ActionValues& informed_;
  const ActionValues& blind_;
  double rounding_;
  std::size_t largest_;  // size of a region that has plans of its own; 0: none has
  double lowest_ = 0;
  double scale_ = 0;
  List<std::size_t> first_of_;  // the first pair of each region
  List<double> values_;         // by pair
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> repeated_;  // the first pair of a region and an action
  List<Plan> plans_;
  List<std::size_t> first_landing_;  // of each target of each plan
  List<Landing> landings_;
  List<double> predicted_;
  List<List<Landing>> of_target_;
  List<std::pair<double, double>> later_;  // by target: the value, and the sum of the absolute values in it
};

}
