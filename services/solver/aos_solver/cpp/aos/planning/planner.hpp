// The planner of a model: the one that was asked for, or the one that suits the model, the belief and the budget.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/base/random.hpp"
#include "aos/base/rounded_text.hpp"
#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/belief_tree.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/despot.hpp"
#include "aos/planning/exact_search.hpp"
#include "aos/planning/exploration.hpp"
#include "aos/planning/group_missions.hpp"
#include "aos/planning/mdp_values.hpp"
#include "aos/planning/near_states.hpp"
#include "aos/planning/option_policy.hpp"
#include "aos/planning/point_based.hpp"
#include "aos/planning/pomcp.hpp"
#include "aos/planning/state_space.hpp"

namespace aos {

enum class PlannerKind { pomcp, despot, sarsop, automatic, exact, belief_tree, options };
inline constexpr const char* planner_names[] = {"pomcp", "despot", "sarsop", "auto", "exact", "belief-tree", "options"};

// The planner of this name, if there is one that can be asked for.
inline std::optional<PlannerKind> planner_kind(std::string_view name) {
  const auto* const last = planner_names + static_cast<std::size_t>(PlannerKind::exact);
  const auto* const found = std::find(planner_names, last, name);
  return found == last ? std::nullopt : std::optional{static_cast<PlannerKind>(found - planner_names)};
}

template <class Model>
class Planner {
 public:
  // Chooses the planner, prepares it and searches. See Pomcp, Despot, PointBased and ExactSearch.
  std::uint64_t search(PlannerKind kind, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred = {}) {
    // Actions that were barred have few visits in the tree and would be neglected further.
    if (barred != barred_) forget();
    barred_ = barred;
    horizon_ = horizon;
    searching_ = {};
    tried_in_vain_ = 0;
    const auto start = thread_time();
    used_ = chosen_kind(kind, belief, budget, horizon, Sampler{Sampler{random}.bits()});
    if (used_ == PlannerKind::despot) despot().prepare(belief, horizon);
    if (used_ == PlannerKind::pomcp) pomcp_.prepare(belief, horizon, budget.threads, random);
    const auto prepared = thread_time();
    preparing_ = prepared - start - searching_;
    const std::uint64_t simulations = searched(belief, budget, horizon, random);
    play_group(belief, budget, horizon, random);
    searching_ += thread_time() - prepared;
    return simulations + tried_in_vain_;
  }

  // The simulations of each thread of POMCP's last search; empty for another planner, which has one thread.
  std::vector<std::uint64_t> simulations_by_thread() const {
    return used_ == PlannerKind::pomcp ? pomcp_.simulations_by_thread() : std::vector<std::uint64_t>{};
  }

  // This thread's processor time of the last search, and that of the lists, values and first bounds before it, which no budget counts.
  std::chrono::duration<double> searching() const { return searching_; }
  std::chrono::duration<double> preparing() const { return preparing_; }

  // The planner of the last search, and why it was that one.
  const char* name() const { return planner_names[static_cast<std::size_t>(used_)]; }
  const std::string& why() const { return why_; }

  // What the search has found of the actions, by which `choice` decides.
  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    switch (used_) {
      case PlannerKind::exact: return exact_.estimates();
      case PlannerKind::despot: return despot_->estimates(belief);
      case PlannerKind::sarsop: return sarsop().estimates();
      case PlannerKind::belief_tree: return belief_tree_.estimates(belief);
      case PlannerKind::options: return options_.estimates();
      default: return pomcp_.estimates(belief);
    }
  }
  // What a decision tells: an estimate of what is returned over the next `horizon` decisions, beginning with each action,
  // while the mission plans anew at each of them (action_values.hpp). `estimates` are those by which `choice` was made.
  std::vector<ActionEstimate> values(const Belief<Model>& belief, std::vector<ActionEstimate> estimates, int choice) const {
    std::vector<ActionEstimate> values = values_of_belief(belief, std::move(estimates), choice);
    const double slack = slack_of(belief);
    for (ActionEstimate& value : values) {
      value.at_least -= slack;
      value.at_most += slack;
    }
    return values;
  }
  // The action to take: the one with the highest estimate among those with reliable values.
  int choice(const std::vector<ActionEstimate>& estimates, const BarredActions& barred = {}) const {
    if (used_ == PlannerKind::exact) return exact_.best(barred);
    const auto is_barred = [&](const ActionEstimate& estimate) {
      return barred.contains(static_cast<std::size_t>(&estimate - estimates.data()));
    };
    ActionEstimate most;  // the most visited one
    for (const ActionEstimate& estimate : estimates) {
      if (!is_barred(estimate) && estimate.n > most.n) most = estimate;
    }
    return preferred_action(estimates, horizon_, [&](const ActionEstimate& estimate) {
      if (is_barred(estimate)) return false;
      if (used_ == PlannerKind::belief_tree) return is_well_visited(estimate.n, most.n);
      if (used_ != PlannerKind::pomcp || pomcp_.has_prior() || estimate.n == 0) return estimate.n > 0;
      return is_well_visited(estimate.n, most.n) || (switches::certain_actions && pomcp_.rolls_out() && is_certain(estimate, most));
    });
  }

  // Searches below the action that is being carried out, if the last planner can use that.
  template <class IsOver>
  void ponder(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random, IsOver&& is_over) {
    if (used_ == PlannerKind::pomcp) {
      pomcp_.prepare(belief, horizon, budget.threads, random);
      pomcp_.ponder(action, belief, budget, horizon, random, is_over);
    }
    if (used_ == PlannerKind::sarsop) sarsop().ponder(action, budget, is_over);
  }
  // How many simulations of earlier searches serve the next one.
  std::uint64_t known_simulations() const {
    return used_ == PlannerKind::sarsop ? sarsop().known_simulations() : pomcp_.known_simulations();
  }

  void move_to(int action, Observation observation) {
    if (used_ == PlannerKind::pomcp) {
      pomcp_.move_to(action, observation);
    } else {
      pomcp_.forget();
    }
  }
  // Drops the trees below the belief, which hold no longer.
  void forget() { pomcp_.forget(); }
  // Begins another mission.
  void start_over() {
    forget();
    space_.start_over();
    exact_.start_over();
    belief_tree_.start_over();
    options_.start_over();
    point_based_.start_over();
    near_.start_over();
    near_search_.start_over();
    missions_.start_over();
  }

 private:
  // The values of states in which the last search ends its tree; null if there is no tree or it ends in rollouts.
  const StateValues<Model>* values_of_tree_ends() const {
    switch (used_) {
      case PlannerKind::pomcp: return pomcp_.state_values();
      case PlannerKind::despot: return despot_->has_values() ? &values_ : nullptr;
      case PlannerKind::belief_tree: return &values_;
      default: return nullptr;
    }
  }
  double mean_value_of_states(const Belief<Model>& belief) const {
    if (used_ == PlannerKind::pomcp) return pomcp_.value_of_states(belief);
    return used_ == PlannerKind::despot ? despot_->value_of_states(belief) : belief_tree_.value_of_states(horizon_);
  }
  // Plays a group of missions where it is time for that (group_missions.hpp).
  void play_group(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    const StateValues<Model>* const values = values_of_tree_ends();
    if (values == nullptr || belief.probability_of(Ending::running) <= 0 || !missions_.is_due(budget, horizon)) return;
    missions_.play(belief, *values, values == &values_ ? &values_ : nullptr, horizon, choice(estimates(belief), barred_),
                   Sampler{random.bits()});
  }

  // Searches by the planner that was chosen and prepared.
  std::uint64_t searched(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random) {
    switch (used_) {
      case PlannerKind::exact: return exact_.play(belief, exact_.best(barred_));
      case PlannerKind::despot: return despot().search(belief, budget, horizon, random, barred_);
      case PlannerKind::belief_tree: return belief_tree_.search(budget, horizon, random, barred_);
      case PlannerKind::options: {
        const std::uint64_t simulations = options_.search(belief, horizon, random, barred_);
        why_ += "; ways to rewards are found by search, and " + std::string{options_.reason()} + " decides";
        return simulations;
      }
      case PlannerKind::sarsop: {
        const std::uint64_t simulations = sarsop().search(budget, [&] { return choice(sarsop().estimates(), barred_); });
        why_ += "; " + bounds_text(horizon, slack_of(belief));
        if (const auto& policy = sarsop().policy()) {
          why_ += "; a simple policy decides, since it returns " + rounded_down(policy->value) + " in played missions";
        }
        if (simulations == 0) why_ += "; preparation and earlier searches have found these bounds, and nothing was searched now";
        return simulations;
      }
      default: {
        const std::uint64_t simulations = pomcp_.search(belief, budget, horizon, random, barred_);
        if (const std::string source = pomcp_.value_source(); !source.empty()) why_ += "; " + source;
        return simulations;
      }
    }
  }

  // Also sets `why_`.
  PlannerKind chosen_kind(PlannerKind asked_for, const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    is_near_ = false;
    if (asked_for == PlannerKind::automatic) return suited_kind(belief, budget, horizon, random);
    why_ = "it was asked for";
    if (asked_for == PlannerKind::options) return options_or_pomcp(belief, budget, horizon, random);
    if (asked_for != PlannerKind::sarsop) return asked_for;
    const std::string obstacle = point_based_obstacle(belief, horizon);
    if (obstacle.empty()) return PlannerKind::sarsop;
    why_ = "SARSOP cannot be used: " + obstacle;
    return PlannerKind::pomcp;
  }

  PlannerKind suited_kind(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    if (!space_.reach(belief)) {
      why_ = space_.obstacle();
      if (serves_near(belief, horizon)) return PlannerKind::sarsop;
      if (!switches::options || Model::has_rollout_policy || pomcp_.has_wide_values(belief, horizon)) return PlannerKind::pomcp;
      return options_or_pomcp(belief, budget, horizon, random);
    }
    why_ = "all " + std::to_string(space_.size()) + " states can be listed";
    if (fits_exact_search(belief, budget, horizon)) {
      why_ += ", and every observation of " + std::to_string(horizon) + " decisions fits the budget";
      return PlannerKind::exact;
    }
    if (space_.leaves_out_observations()) {
      why_ += ", but not what is observed: " + space_.observations_obstacle();
      return belief_tree_or_pomcp(belief, horizon);
    }
    if (const std::string obstacle = point_based_.prepare(belief, horizon); !obstacle.empty()) {
      why_ += "; SARSOP cannot be used: " + obstacle;
      if (!switches::despot_rule) return PlannerKind::pomcp;
      return space_.lists_observations() ? PlannerKind::despot : belief_tree_or_pomcp(belief, horizon);
    }
    return PlannerKind::sarsop;
  }

  bool fits_exact_search(const Belief<Model>& belief, Budget budget, int horizon) {
    if (!switches::exact || !space_.lists_observations() || !belief.is_exact() || !exact_.prepare(horizon)) return false;
    const auto start = thread_time();
    const bool fits = exact_.search(belief, budget, horizon);
    searching_ += thread_time() - start;
    if (!fits) tried_in_vain_ = exact_.simulations();
    return fits;
  }

  PlannerKind options_or_pomcp(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    const auto start = thread_time();
    const std::string obstacle = options_.prepare(belief, budget, horizon, random);
    searching_ += thread_time() - start;
    if (!obstacle.empty()) {
      why_ += "; " + obstacle;
      return PlannerKind::pomcp;
    }
    return PlannerKind::options;
  }

  PlannerKind belief_tree_or_pomcp(const Belief<Model>& belief, int horizon) {
    if (!switches::belief_tree) return PlannerKind::pomcp;
    if (const std::string obstacle = belief_tree_.prepare(belief, horizon); !obstacle.empty()) {
      why_ += "; their probabilities cannot be estimated: " + obstacle;
      return PlannerKind::pomcp;
    }
    why_ += "; their probabilities are estimated";
    return PlannerKind::belief_tree;
  }

  std::string point_based_obstacle(const Belief<Model>& belief, int horizon) {
    if (!space_.reach(belief)) return serves_near(belief, horizon) ? "" : space_.obstacle();
    return space_.leaves_out_observations() ? space_.observations_obstacle() : point_based_.prepare(belief, horizon);
  }
  // Whether the states near a belief can stand for all of them. The missions that tell a value make as many decisions as the
  // horizon has, each of them with a whole horizon to go.
  bool serves_near(const Belief<Model>& belief, int horizon) {
    const int decisions = 2 * horizon;
    is_near_ = switches::near_states && near_.reach(belief, decisions) && near_search_.prepare(belief, horizon).empty();
    if (is_near_) {
      why_ += "; the " + std::to_string(near_.space().size()) + " states that " + std::to_string(decisions) +
              " decisions can lead to are listed";
    }
    return is_near_;
  }
  // How far bounds have to be widened; see StateSpace.
  double slack_of(const Belief<Model>& belief) const { return (is_near_ ? near_.space() : space_).slack(belief, horizon_); }
  PointBased<Model>& sarsop() { return is_near_ ? near_search_ : point_based_; }
  const PointBased<Model>& sarsop() const { return is_near_ ? near_search_ : point_based_; }

  // The values if the belief is what it should be.
  std::vector<ActionEstimate> values_of_belief(const Belief<Model>& belief, std::vector<ActionEstimate> estimates, int choice) const {
    switch (used_) {
      case PlannerKind::exact: return exact_.values();
      case PlannerKind::options: return estimates;
      case PlannerKind::sarsop: return sarsop().values(std::move(estimates), choice);
      default: return values_of_search(belief, std::move(estimates), choice);
    }
  }
  std::vector<ActionEstimate> values_of_search(const Belief<Model>& belief, std::vector<ActionEstimate> estimates, int choice) const {
    bound(belief, estimates);
    if (used_ == PlannerKind::despot) {
      for (ActionEstimate& estimate : estimates) estimate.standard_error = despot_->error(belief);
    }
    const bool was_searched = estimates[static_cast<std::size_t>(choice)].n > 0;
    if (values_of_tree_ends() == nullptr) {
      const TreeReach reach = used_ == PlannerKind::despot ? despot_->reach(belief) : pomcp_.reach(estimates, choice, belief);
      return values_of_tree(std::move(estimates), reach, choice);
    }
    if (!was_searched || !missions_.is_known()) return estimates;
    const double most = used_ == PlannerKind::despot ? despot_->upper(belief, choice) : estimates[static_cast<std::size_t>(choice)].q;
    const double running = belief.probability_of(Ending::running);
    const double played = mean_value_of_states(belief) - running * missions_.loss();
    const bool is_guess = used_ == PlannerKind::pomcp && pomcp_.has_learned_values();
    return values_of_promise(std::move(estimates), {most, played, running * missions_.loss_error(), is_guess}, choice);
  }

  std::string bounds_text(int horizon, double slack) const {
    const auto [lowest, highest] = sarsop().bounds();
    const double lower = lowest - slack, upper = highest + slack;
    const std::string scope = sarsop().is_endless() ? "without a horizon" : "with " + std::to_string(horizon) + " decisions to go";
    if (sarsop().tells_by_cells()) {
      return scope + " the belief is worth at least " + rounded_down(lower) + ", telling numbers by " +
             std::to_string(sarsop().cells()) + " cells";
    }
    return scope + " the belief is worth between " + rounded_down(lower) + " and " + rounded_up(upper);
  }

  // Sets the most that each action may return, where the states are listed and have been valued.
  void bound(const Belief<Model>& belief, std::vector<ActionEstimate>& estimates) const {
    if (!values_.knows(horizon_)) return;
    const std::vector<double> most = values_.at_most(space_.weights_of(belief));
    for (std::size_t a = 0; a < estimates.size(); ++a) estimates[a].at_most = most[a];
  }

  Despot<Model>& despot() {
    if (!despot_) despot_ = std::make_unique<Despot<Model>>(values_);
    return *despot_;
  }

  StateSpace<Model> space_;
  MdpValues<Model> values_{space_};
  Pomcp<Model> pomcp_{space_, values_};
  ExactSearch<Model> exact_{space_};
  PointBased<Model> point_based_{space_};
  NearStates<Model> near_;
  PointBased<Model> near_search_{near_.space(), false};
  bool is_near_ = false;  // whether the states near the belief stood for all of them in the last search
  BeliefTree<Model> belief_tree_{space_, values_};
  OptionPolicy<Model> options_;
  std::unique_ptr<Despot<Model>> despot_;
  GroupMissions<Model> missions_;
  PlannerKind used_ = PlannerKind::pomcp;
  int horizon_ = 1;       // of the last search
  BarredActions barred_;  // in the last search
  std::string why_;
  std::uint64_t tried_in_vain_ = 0;  // simulations of exact search
  std::chrono::nanoseconds preparing_{};
  std::chrono::nanoseconds searching_{};
};

}  // namespace aos
