// The planners of a model, and which of them decides: the one that was asked for, or the first that can.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/planning/belief_tree/belief_tree.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/despot/despot.hpp"
#include "aos/planning/idle_actions.hpp"
#include "aos/planning/listed/exact_search.hpp"
#include "aos/planning/listed/sarsop_planner.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/options/options_planner.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/pomcp/pomcp.hpp"
#include "aos/planning/savings/savings_planner.hpp"
#include "aos/planning/seek/seek_planner.hpp"
#include "aos/planning/values/group_missions.hpp"
#include "aos/planning/values/mdp_values.hpp"

namespace aos {

// What can be asked for.
enum class PlannerKind { automatic, pomcp, despot, sarsop };
inline constexpr const char* planner_names[] = {"auto", "pomcp", "despot", "sarsop"};

// The planner of this name, if there is one that can be asked for.
inline std::optional<PlannerKind> planner_kind(std::string_view name) {
  const auto* const found = std::ranges::find(planner_names, name);
  return found == std::end(planner_names) ? std::nullopt : std::optional{static_cast<PlannerKind>(found - planner_names)};
}

template <class Model>
class Planners {
 public:
  // Chooses the planner, prepares it and searches. Returns how many simulations it took, as budget.hpp counts them.
  std::uint64_t search(PlannerKind kind, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred = {}) {
    // Actions that were barred have few visits in the tree and would be neglected further.
    if (barred != barred_) forget();
    barred_ = barred;
    horizon_ = horizon;
    const auto start = thread_time();
    Choosing choosing;
    const bool is_by_name = kind != PlannerKind::automatic;
    const Question<Model> question{belief, budget, horizon, barred_, is_by_name, space_.reach(belief)};
    choosing.why = is_by_name ? "it was asked for" : question.is_listed ? space_.listed_text() : space_.obstacle();
    const auto& order = order_[static_cast<std::size_t>(kind)];
    used_ = &(*std::ranges::find_if(order, [&](Planner<Model>* planner) { return planner->prepare(question, random, choosing); }))->decider();
    const auto prepared = thread_time();
    const Question<Model> left{belief, budget.left_after(std::chrono::duration<double>(choosing.spent).count()), horizon, barred_, is_by_name, question.is_listed};
    const std::uint64_t simulations = used_->search(left, random, choosing.why);
    why_ = std::move(choosing.why);
    preparing_ = prepared - start - choosing.searching;
    searching_ = choosing.searching + thread_time() - prepared;
    return simulations + choosing.simulations;
  }

  // This thread's processor time of the last search, and that of the lists, values and first bounds before it, which no budget counts.
  std::chrono::duration<double> searching() const { return searching_; }
  std::chrono::duration<double> preparing() const { return preparing_; }

  // The planner of the last search, and why it was that one.
  const char* name() const { return used_->name(); }
  const std::string& why() const { return why_; }

  // See Planner.
  Estimates estimates(const Belief<Model>& belief) const { return used_->estimates(belief); }
  int choice(const Estimates& estimates, const BarredActions& barred = {}) const {
    return used_->choice(estimates, horizon_, barred);
  }
  // The same, but after an idle action the decision is the same one again: it is worth no more than the best of the others, if that is worth more
  // than to idle until the horizon.
  int choice(const Belief<Model>& belief, const Estimates& estimates, BarredActions barred) const {
    const int best = choice(estimates, barred);
    if (!switches::no_idling || !used_->may_put_off()) return best;
    double idling = -std::numeric_limits<double>::infinity();
    int other = best;
    while (const std::optional<double> earned = earned_idle(belief, other)) {
      idling = std::max(idling, *earned * discounted_steps<Model>(horizon_));
      barred.insert(other);
      other = choice(estimates, barred);
      if (barred.contains(other) || estimates[other].n == 0) return best;
    }
    return other == best || estimates[other].q > idling ? other : best;
  }
  List<std::uint64_t> simulations_by_thread() const { return used_->simulations_by_thread(); }
  std::uint64_t known_simulations() const { return used_->known_simulations(); }

  // What a decision tells: an estimate of what is returned over the next `horizon` decisions, beginning with each action,
  // while the mission plans anew at each of them (action_values.hpp). `estimates` are those by which `choice` was made.
  Estimates values(const Belief<Model>& belief, Estimates estimates, int choice) const {
    Estimates values = used_->values(belief, std::move(estimates), choice);
    const double slack = used_->slack(belief, horizon_);
    const double of_draws = space_.error_of_draws(horizon_);
    for (ActionEstimate& value : values) {
      if (value.n > 0) value.standard_error = std::hypot(value.standard_error, of_draws);
      value.at_least -= slack;
      value.at_most += slack;
      // Of an action that was not tried nothing is told but its bounds.
      if (value.n == 0) value.q = std::clamp(0.0, value.at_least, value.at_most);
    }
    return values;
  }

  // Searches below the action that is being carried out, if the last planner can use that.
  void ponder(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random, auto&& is_over) {
    used_->ponder(action, {belief, budget, horizon, barred_}, random, is_over);
  }
  void move_to(int action, Observation observation) {
    for (Planner<Model>* const planner : all_) {
      if (planner == used_) planner->advance(action, observation);
      else planner->forget();
    }
  }
  // Drops what holds for the last belief only.
  void forget() {
    for (Planner<Model>* const planner : all_) planner->forget();
  }
  // Begins another mission.
  void start_over() {
    space_.start_over();
    missions_.start_over();
    for (Planner<Model>* const planner : all_) planner->start_over();
  }

 private:
  using Order = List<Planner<Model>*>;

  StateSpace<Model> space_;
  MdpValues<Model> values_{space_};
  GroupMissions<Model> missions_;
  Pomcp<Model> pomcp_{space_, values_, missions_};
  Pomcp<Model> rollouts_{space_, values_, missions_, false};  // without values of states
  ExactSearch<Model> exact_{space_};
  SarsopPlanner<Model> sarsop_{space_};
  BeliefTree<Model> belief_tree_{space_, values_, missions_};
  SeekPlanner<Model> seek_{space_, pomcp_};
  OptionsPlanner<Model> options_{space_, pomcp_, seek_};
  SavingsPlanner<Model> savings_{space_, options_, rollouts_, missions_};
  Despot<Model> despot_{space_, values_, missions_};
  const Order all_{&exact_, &sarsop_, &belief_tree_, &options_, &savings_, &rollouts_, &seek_, &pomcp_, &despot_};
  // Which planners are tried in turn, by what was asked for. The last ones can always decide.
  const Order order_[std::size(planner_names)] = {
      {&exact_, &sarsop_, &belief_tree_, &options_, &savings_, &seek_, &pomcp_}, {&pomcp_}, {&despot_}, {&sarsop_, &pomcp_}};

  Planner<Model>* used_ = &pomcp_;
  int horizon_ = 1;       // of the last search
  BarredActions barred_;  // in the last search
  std::string why_;
  std::chrono::nanoseconds preparing_{};
  std::chrono::nanoseconds searching_{};
};

}
