// Anytime regularised DESPOT (Ye, Somani, Hsu and Lee, 2017): heuristic search in a sparse tree of the
// histories that a fixed number of scenarios lead to.
//
// A trial goes down from the root, by the action with the highest upper bound and the observation whose gap exceeds
// most what is allowed there. It ends where nothing is left to gain, and the new leaf's bounds are backed up. The value
// of an action is its lower bound: what the best policy in the tree earns in the scenarios, less a penalty for each
// decision. The penalty keeps a policy from fitting the luck of the scenarios.
//
// The bounds and the default policies are in scenarios.hpp. The number of scenarios follows from the budget. The
// penalty follows from the spread of the scenarios' returns: a decision has to be worth a deviation of one scenario.
//
// A node's bounds are sums over its scenarios, divided by the number of all and discounted from the root.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/despot/despot_constants.hpp"
#include "aos/planning/despot/scenarios.hpp"
#include "aos/planning/tree_planner.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

template <class Model>
class Despot final : public TreePlanner<Model> {
 public:
  using State = typename Model::State;

  Despot(const StateSpace<Model>& space, MdpValues<Model>& values, GroupMissions<Model>& missions)
      : TreePlanner<Model>(space, values, missions), evaluation_(values), values_(values) {}

  const char* name() const override { return "despot"; }

  // Prepares the values of states. The first decision may take some seconds here, later ones take next to nothing.
  bool prepare(const Question<Model>& question, Sampler& /*random*/, Choosing& /*choosing*/) override {
    if (nodes_.capacity() == 0) {
      nodes_.reserve(max_node_bytes / sizeof(Node));
      actions_.reserve(max_node_bytes / sizeof(ActionNode));
      scenarios_.reserve(max_scenario_bytes / scenario_bytes());
    }
    evaluation_.prepare(question.belief, question.horizon);
    return true;
  }

  // The standard errors follow from the number of scenarios.
  Estimates estimates(const Belief<Model>& belief) const override {
    Estimates result(action_count());
    if (nodes_.size() == 0 || nodes_[0].first_action == no_node) return result;
    const double running = belief.probability_of(Ending::running);
    for (std::size_t a = 0; a < deviations_.size(); ++a) {
      const ActionNode& action = actions_[nodes_[0].first_action + a];
      result[a] = {running * (origin_ + action.lower), action.trials, running * deviations_[a], running * rewards_[a]};
    }
    return result;
  }
  Estimates values(const Belief<Model>& belief, Estimates estimates, int choice) const override {
    for (ActionEstimate& estimate : estimates) {
      if (estimate.n > 0) estimate.standard_error = error(belief);
    }
    return TreePlanner<Model>::values(belief, std::move(estimates), choice);
  }

 protected:
  std::uint64_t search_tree(const Question<Model>& question, Sampler& random, std::string& /*why*/) override {
    const ForgottenTexts forgotten;
    const Belief<Model>& belief = question.belief;
    const Budget budget = question.budget;
    using Seconds = std::chrono::duration<double>;
    budget_ = budget;
    latest_ = budget.seconds > 0
                  ? PlanningClock::now() + std::chrono::duration_cast<PlanningClock::duration>(Seconds{budget.seconds})
                  : PlanningClock::time_point::max();
    horizon_ = question.horizon;
    barred_ = question.barred;
    nodes_.clear();
    actions_.clear();
    scenarios_.clear();
    deviations_.clear();
    rewards_.clear();
    if (action_count() == 0 || !plant(belief, random)) return 0;
    while (may_go_on() && explore()) {
    }
    return simulations();
  }

  const StateValues<Model>* values_of_ends() const override { return evaluation_.has_values() ? &values_ : nullptr; }
  double value_of_states(const Belief<Model>& belief) const override { return belief.probability_of(Ending::running) * origin_; }
  // The upper bound of an action that was tried: what the scenarios may return.
  double most(const Belief<Model>& belief, const Estimates& /*estimates*/, int action) const override {
    const ActionNode& node = actions_[nodes_[0].first_action + static_cast<std::size_t>(action)];
    return belief.probability_of(Ending::running) * (origin_ + node.upper);
  }
  // What it has gained is that over the default policies.
  TreeReach reach(const Belief<Model>& belief, const Estimates& /*estimates*/, int /*choice*/) const override {
    TreeReach result;
    result.beyond.assign(action_count(), 1);
    if (nodes_.size() == 0 || nodes_[0].first_action == no_node) return result;
    result.gain = belief.probability_of(Ending::running) * (nodes_[0].lower - nodes_[0].default_lower);
    for (std::size_t a = 0; a < deviations_.size(); ++a) {
      result.beyond[a] = beyond_action(actions_[nodes_[0].first_action + a]);
    }
    return result;
  }

 private:
  // The standard error of what a policy earns in the scenarios.
  double error(const Belief<Model>& belief) const {
    return belief.probability_of(Ending::running) * penalty_ / penalty_in_deviations * std::sqrt(static_cast<double>(scenario_count_));
  }
  static std::size_t scenario_bytes() { return sizeof(Scenario<Model>) + Model::bytes_elsewhere(); }
  using Evaluation = ScenarioEvaluation<Model>;

  struct Node {
    std::uint32_t first_scenario;
    std::uint32_t scenarios;
    std::uint32_t depth;
    std::uint32_t parent;  // an action
    std::uint32_t sibling;
    std::uint32_t first_action;
    double lower;
    double upper;
    double default_lower;
    double first_upper;
  };
  struct ActionNode {
    std::uint32_t parent;  // a node
    std::uint32_t first_child;
    std::uint32_t trials;
    double reward;  // less the penalty
    double lower;
    double upper;
  };
  static std::size_t action_count() { return static_cast<std::size_t>(Model::action_count()); }
  bool may_go_on() const {
    return (budget_.simulations == 0 || simulations() < budget_.simulations) && PlanningClock::now() < latest_;
  }
  std::uint64_t simulations() const { return Budget::simulations_of(evaluation_.work(), horizon_); }

  // The discounted share of the scenarios that come to where the tree ends, by the best actions.
  double beyond_action(const ActionNode& action) const {
    double sum = 0;
    for (std::uint32_t child = action.first_child; child != no_node; child = nodes_[child].sibling) sum += beyond_node(child);
    return sum;
  }
  double beyond_node(std::uint32_t number) const {
    const Node& node = nodes_[number];
    const double end = weight_at(node.depth) * node.scenarios;
    if (node.first_action == no_node || node.lower <= node.default_lower) return end;
    for (std::size_t a = 0; a < action_count(); ++a) {
      if (actions_[node.first_action + a].lower >= node.lower) return beyond_action(actions_[node.first_action + a]);
    }
    return end;
  }

  // --- the root

  // Makes the root. Returns false if there is nothing to decide.
  bool plant(const Belief<Model>& belief, Sampler& random) {
    const double running = belief.probability_of(Ending::running);
    if (running <= 0) return false;
    evaluation_.start(random.bits());
    draw_scenarios(belief, min_scenarios, running, random);
    const PlanningClock::time_point start = PlanningClock::now();
    evaluation_.bounds(outcomes_, 0);
    const PlanningClock::duration spent = PlanningClock::now() - start;
    draw_scenarios(belief, affordable_scenarios(spent), running, random);
    if (outcomes_.empty()) return false;
    origin_ = 0;
    for (const Observed<Model>& outcome : outcomes_) origin_ += evaluation_.origin(outcome.scenario.seen) / scenario_count_;
    const List<ScenarioBounds>& bounds = evaluation_.bounds(outcomes_, 0);
    penalty_ = penalty_in_deviations * evaluation_.deviation() / scenario_count_;
    add_node(0, outcomes_.size(), 0, no_node, bounds);
    expand(0);
    return true;
  }

  // Draws about `count` scenarios. States that have ended need no decision and are left out.
  void draw_scenarios(const Belief<Model>& belief, std::size_t count, double running, Sampler& random) {
    outcomes_.clear();
    draw_evenly<Model>(belief.particles(), static_cast<std::size_t>(std::ceil(count / running)), random,
                       [&](const State& state) {
                         if (Model::ending(state) != Ending::running) return;
                         const std::uint32_t number = outcomes_.size();
                         outcomes_.push_back({{state, number, evaluation_.seen(state)}, default_observation});
                       });
    scenario_count_ = outcomes_.size();
  }

  // How many scenarios the budget allows, by the time or the work that the fewest scenarios took.
  std::size_t affordable_scenarios(PlanningClock::duration spent) const {
    double share = 1;  // of max_scenarios
    const auto affordable_share = [&](double budget, double spent_on_fewest) {
      return share_of_first_look * budget * min_scenarios / (spent_on_fewest * action_count() * max_evaluated);
    };
    if (budget_.simulations > 0) {
      const auto budget = static_cast<double>(budget_.operations(horizon_));
      share = affordable_share(budget, static_cast<double>(std::max<Operations>(evaluation_.work(), 1)));
    } else if (budget_.seconds > 0) {
      share = affordable_share(budget_.seconds, std::chrono::duration<double>(spent).count());
    }
    const auto affordable = static_cast<std::size_t>(std::min(share, 1.0) * max_scenarios);
    const std::size_t room = std::min(max_node_bytes / sizeof(Node), max_scenario_bytes / scenario_bytes());
    return std::clamp(room / (2 * action_count()), std::size_t{1}, std::max(affordable, min_scenarios));
  }

  // --- the tree

  // Adds a node for the outcomes from `first` to `last`.
  std::uint32_t add_node(std::size_t first, std::size_t last, int depth, std::uint32_t parent,
                         const List<ScenarioBounds>& bounds) {
    ScenarioBounds sum;
    const std::size_t first_scenario = scenarios_.size();
    for (std::size_t i = first; i < last; ++i) {
      scenarios_.push_back(outcomes_[i].scenario);
      sum.lower += bounds[i].lower;
      sum.upper += bounds[i].upper;
    }
    const double lower = weight_at(depth) * sum.lower;
    const double upper = weight_at(depth) * std::max(sum.upper, sum.lower);
    nodes_.push_back({static_cast<std::uint32_t>(first_scenario), static_cast<std::uint32_t>(last - first),
                      static_cast<std::uint32_t>(depth), parent, no_node, no_node, lower, upper, lower, upper});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  double weight_at(int depth) const { return std::pow(Model::discount, depth) / scenario_count_; }

  // Adds all actions of a node and their children. Returns false without the memory or the time for them.
  bool expand(std::uint32_t number) {
    const std::size_t max_new = action_count() * nodes_[number].scenarios;
    if (!scenarios_.has_room(max_new) || !nodes_.has_room(max_new) || !actions_.has_room(action_count())) return false;
    const std::uint32_t first_action = actions_.size();
    bool has_tried = false;
    for (std::size_t a = 0; a < action_count(); ++a) {
      // At the root an action is tried in any case that can be taken.
      if (has_tried && !may_go_on()) {
        if (number != 0) return false;
        break;
      }
      try_action(number, a);
      has_tried = has_tried || !is_barred(number, a);
    }
    nodes_[number].first_action = first_action;
    update(number);
    return true;
  }

  void try_action(std::uint32_t number, int a) {
    const Node node = nodes_[number];
    const int depth = node.depth;
    double reward = 0;
    double squares = 0;
    double immediate = 0;
    outcomes_.clear();
    for (std::size_t i = node.first_scenario; i < node.first_scenario + node.scenarios; ++i) {
      Observed<Model> outcome{scenarios_[i], default_observation};
      bool has_ended = false;
      const Step step = evaluation_.step(outcome.scenario, a, depth, has_ended);
      const double earned = evaluation_.earned(scenarios_[i].seen, a, depth, step.reward);
      reward += earned;
      squares += earned * earned;
      immediate += step.reward;
      outcome.observation = step.observation;
      if (has_ended || depth + 1 == horizon_) continue;
      outcomes_.push_back(outcome);
    }
    sort_by_observation(outcomes_, 0, outcomes_.size());

    const std::uint32_t action_number = actions_.size();
    const double earned = weight_at(depth) * reward - penalty_;
    ActionNode& action = actions_.emplace_back(ActionNode{number, no_node, number == 0 ? 1u : 0u, earned, earned, earned});
    const List<ScenarioBounds>& bounds = evaluation_.bounds(outcomes_, depth + 1);
    for_each_history(outcomes_, [&](std::size_t first, std::size_t last) {
      const std::uint32_t child = add_node(first, last, depth + 1, action_number, bounds);
      nodes_[child].sibling = std::exchange(action.first_child, child);
      action.lower += nodes_[child].lower;
      action.upper += nodes_[child].upper;
    });
    if (number == 0) {
      const auto count = static_cast<double>(node.scenarios);
      const double variance = std::max(squares / count - (reward / count) * (reward / count), 0.0);
      deviations_.push_back(std::sqrt(variance / count));
      rewards_.push_back(immediate / count);
    }
  }

  // Computes the node's bounds from those of its actions.
  void update(std::uint32_t number) {
    Node& node = nodes_[number];
    double lower = node.default_lower;
    double upper = node.default_lower;
    for (std::size_t a = 0; a < tried_actions(number); ++a) {
      if (is_barred(number, a)) continue;
      lower = std::max(lower, actions_[node.first_action + a].lower);
      upper = std::max(upper, actions_[node.first_action + a].upper);
    }
    node.lower = lower;
    node.upper = upper;
  }
  bool is_barred(std::uint32_t number, std::size_t action) const { return number == 0 && barred_.contains(action); }
  std::size_t tried_actions(std::uint32_t number) const { return number == 0 ? deviations_.size() : action_count(); }

  // --- trials

  // Runs one trial. Returns false once the bounds have met or nothing can be added.
  bool explore() {
    if (nodes_[0].first_action == no_node || nodes_[0].upper - nodes_[0].lower <= 1e-9) return false;
    std::uint32_t number = 0;
    bool has_changed = false;
    while (excess(number) > 0 || number == 0) {
      if (nodes_[number].first_action == no_node) {
        if (is_blocked(number)) {
          nodes_[number].upper = nodes_[number].lower = nodes_[number].default_lower;
          has_changed = true;
          break;
        }
        if (!expand(number)) break;
        has_changed = true;
      }
      const std::uint32_t child = promising_child(number);
      if (child == no_node) break;
      number = child;
    }
    back_up(number);
    return has_changed;
  }

  double gap(std::uint32_t number) const { return nodes_[number].upper - nodes_[number].lower; }
  double excess(std::uint32_t number) const {
    const double share = static_cast<double>(nodes_[number].scenarios) / static_cast<double>(scenario_count_);
    return gap(number) - gap_share * share * gap(0);
  }

  // The child by the action with the highest upper bound and the observation with the largest excess.
  std::uint32_t promising_child(std::uint32_t number) {
    const Node& node = nodes_[number];
    std::uint32_t best = no_node;
    for (std::size_t a = 0; a < tried_actions(number); ++a) {
      const auto candidate = static_cast<std::uint32_t>(node.first_action + a);
      if (is_barred(number, a)) continue;
      if (best == no_node || actions_[candidate].upper > actions_[best].upper) best = candidate;
    }
    if (best == no_node) return no_node;
    ++actions_[best].trials;
    std::uint32_t chosen = no_node;
    double max_excess = -std::numeric_limits<double>::infinity();
    for (std::uint32_t child = actions_[best].first_child; child != no_node; child = nodes_[child].sibling) {
      if (excess(child) <= max_excess) continue;
      max_excess = excess(child);
      chosen = child;
    }
    return chosen;
  }

  // Whether an ancestor's upper bound promises no more than the penalties of the decisions down to here.
  bool is_blocked(std::uint32_t number) const {
    std::uint32_t ancestor = number;
    for (int decisions = 1; nodes_[ancestor].parent != no_node; ++decisions) {
      ancestor = actions_[nodes_[ancestor].parent].parent;
      if (nodes_[ancestor].first_upper - nodes_[ancestor].default_lower <= penalty_ * decisions) return true;
    }
    return false;
  }

  void back_up(std::uint32_t number) {
    while (true) {
      if (nodes_[number].first_action != no_node) update(number);
      if (nodes_[number].parent == no_node) return;
      ActionNode& action = actions_[nodes_[number].parent];
      action.lower = action.upper = action.reward;
      for (std::uint32_t child = action.first_child; child != no_node; child = nodes_[child].sibling) {
        action.lower += nodes_[child].lower;
        action.upper += nodes_[child].upper;
      }
      number = action.parent;
    }
  }

  Evaluation evaluation_;
  const MdpValues<Model>& values_;
  Budget budget_;
  PlanningClock::time_point latest_;
  int horizon_ = 0;
  BarredActions barred_;
  std::size_t scenario_count_ = 0;
  double origin_ = 0;  // the value that all others are relative to
  double penalty_ = 0;
  List<Node> nodes_;
  List<ActionNode> actions_;
  List<Scenario<Model>> scenarios_;
  List<Observed<Model>> outcomes_;  // of the action that is being tried
  List<double> deviations_;  // standard errors of the root's actions that were tried
  List<double> rewards_;     // mean immediate rewards of these actions
};

}
