// Search in a tree of beliefs (PFT-DPW: Sunberg and Kochenderfer, 2018), for models whose states can be listed and whose
// observations are too many for a tree of histories. The probabilities of observations are looked up (sensing_tables.hpp).
//
// Departures from the paper: an action's value is that of the beliefs after it on average, a belief's value that of its best
// action, and a new belief is worth what it is if all is seen after one action (QMDP). That promises too much of an action that
// tells nothing. What a belief is worth less than its states if they are seen is a concave function of it, and never below 0. So
// of a belief that has a share of another one in it, at least this share of what that one loses is lost.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/progress.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"
#include "aos/planning/belief_tree/sensed_belief.hpp"
#include "aos/planning/belief_tree/sensing_tables.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/pomcp/best_action.hpp"
#include "aos/planning/tree_planner.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "numbers/belief_key.hpp"

namespace aos {

inline constexpr std::size_t spreading = 7919;  // a prime, by which states are taken in an order that is spread out

template <class Model>
class BeliefTree final : public TreePlanner<Model> {
 public:
  BeliefTree(const StateSpace<Model>& space, MdpValues<Model>& values, GroupMissions<Model>& missions)
      : TreePlanner<Model>(space, values, missions), space_(space), values_(values) {}

  const char* name() const override { return "belief-tree"; }

  bool prepare(const Question<Model>& question, Sampler& /*random*/, Choosing& choosing) override {
    // Its tables repeat the draws of listed outcomes, and an estimated draw has no outcomes of its own.
    if (!switches::belief_tree || !question.is_listed || space_.lists_observations() || space_.estimates_draws()) return false;
    const std::string obstacle = prepare(question.belief, question.horizon);
    choosing.why += obstacle.empty() ? "; their probabilities are estimated" : "; their probabilities cannot be estimated: " + obstacle;
    return obstacle.empty();
  }

  // Makes tables for a belief of listed states. Returns why they do not tell what observations tell; empty if they do.
  std::string prepare(const Belief<Model>& belief, int horizon) {
    if (!values_.prepare(belief, horizon)) return space_.obstacle();
    tables_.prepare();
    root_.clear();
    for (const auto& [state, weight] : space_.weights_of(belief)) root_.emplace_back(state, static_cast<float>(weight));
    const std::uint64_t last_run = tables_.runs() + max_prepared_runs;
    for (std::size_t i = 0; i < root_.size() && tables_.runs() < last_run; ++i) {
      progress::tell("finding out what observations tell", i, root_.size());
      const std::uint32_t state = root_[i * spreading % root_.size()].first;
      for (std::size_t action = 0; action < space_.actions(); ++action) tables_.fill(space_.rows().row(state, action));
    }
    return tables_.unknown_share() > max_unknown_share ? "hardly a response comes twice" : "";
  }

  void start_over() override { tables_.forget(); }

  // See `search`.
  std::uint64_t search_from_root(Budget budget, int horizon, Sampler& random, const BarredActions& barred) {
    const auto start = PlanningClock::now();
    barred_ = barred;
    horizon_ = horizon;
    nodes_.clear();
    actions_.clear();
    states_.clear();
    work_ = 0;
    if (root_.empty()) return 0;
    add_node(root_, horizon);
    constexpr std::uint64_t between_looks = 16;
    const Operations limit = budget.operations(horizon);
    const bool has_limit = budget.simulations > 0 || budget.seconds <= 0;
    for (std::uint64_t i = 1; horizon > 1 && !(has_limit && work_ >= limit); ++i) {
      simulate(random);
      if (i % between_looks == 0 && budget.seconds > 0 && seconds_since(start) >= budget.seconds) break;
    }
    for (std::size_t a = 0; a < space_.actions(); ++a) renew(0, a);
    return Budget::simulations_of(work_, horizon);
  }

  Estimates estimates(const Belief<Model>& belief) const override {
    Estimates result(space_.actions());
    if (nodes_.empty()) return result;
    const double running = belief.probability_of(Ending::running);
    for (std::size_t a = 0; a < space_.actions(); ++a) {
      const ActionNode& action = actions_[a];
      const double error = action.children.empty() ? 0 : std::sqrt(variance(action) / action.children.size());
      result[a] = {running * action.q, action.n + 1, running * error, running * action.reward};
    }
    return result;
  }

 protected:
  std::uint64_t search_tree(const Question<Model>& question, Sampler& random, std::string& /*why*/) override {
    return search_from_root(question.budget, question.horizon, random, question.barred);
  }
  const StateValues<Model>* values_of_ends() const override { return &values_; }
  double value_of_states(const Belief<Model>& /*belief*/) const override {
    double sum = 0;
    for (const auto& [state, weight] : root_) sum += weight * values_.value(state, horizon_);
    return sum;
  }
  bool is_reliable(const ActionEstimate& estimate, const ActionEstimate& most) const override {
    return is_well_visited(estimate.n, most.n);
  }

 private:
  static constexpr Operations per_value = 15;    // of an action in a state
  static constexpr Operations per_outcome = 40;  // that is weighed by an observation
  static constexpr Operations per_visit = 60;
  static constexpr Operations per_action = 10;   // that is compared with others
  static constexpr int most_rounds = 32;  // in which a value settles
  static constexpr double settled = 1e-4;

  struct ActionNode {
    double q = 0;
    double reward = 0;
    double running = 0;  // the probability that the mission goes on
    double mean = 0;     // of the values of the beliefs after it
    double squares = 0;  // of their distances from it, on average
    std::uint32_t n = 0;
    List<std::uint32_t> children;  // as they were drawn: an equal belief comes again
  };
  struct Node {
    std::size_t first = 0;  // its states
    std::size_t last = 0;
    BeliefKey key;
    std::uint32_t times = 0;  // how often it was drawn
    std::uint32_t n = 0;
    double seen = 0;   // its value if the state is seen
    double value = 0;  // of its best action
    std::uint32_t like = no_node;  // the belief on the way to it that it has the largest share of
    double share = 0;
  };
  struct Visit {
    std::uint32_t node;
    std::size_t action;
  };

  bool is_full() const {
    return actions_.size() * sizeof(ActionNode) + states_.size() * sizeof states_[0] > max_belief_tree_bytes;
  }
  std::span<ActionNode> actions_of(std::uint32_t node) { return {&actions_[node * space_.actions()], space_.actions()}; }
  bool is_barred(std::uint32_t node, std::size_t action) const { return node == 0 && barred_.contains(action); }

  std::uint32_t add_node(const SmallBelief& belief, int left) {
    const std::uint32_t number = nodes_.size();
    nodes_.push_back({states_.size(), states_.size() + belief.size(), key_of(belief)});
    states_.insert(states_.end(), belief.begin(), belief.end());
    actions_.resize(actions_.size() + space_.actions());
    double total = 0;
    double seen = 0;
    for (const auto& [state, weight] : belief) {
      total += weight;
      seen += weight * values_.value(state, left);
    }
    nodes_[number].seen = seen / total;
    for (std::size_t a = 0; a < space_.actions(); ++a) {
      ActionNode& action = actions_of(number)[a];
      for (const auto& [state, weight] : belief) {
        const std::size_t row = space_.rows().row(state, a);
        action.q += weight / total * values_.action_value(state, a, left);
        action.reward += weight / total * space_.rows().rewards[row];
      }
    }
    work_ += per_value * belief.size() * space_.actions();
    nodes_[number].value = best_action(number).q;
    return number;
  }

  // Goes down to a new belief or to an end, and backs up.
  void simulate(Sampler& random) {
    visits_.clear();
    std::uint32_t node = 0;
    for (int left = horizon_; left > 1; --left) {
      const std::size_t a = choose(node);
      visits_.push_back({node, a});
      work_ += per_visit + per_action * space_.actions();
      ++nodes_[node].n;
      ActionNode& action = actions_of(node)[a];
      if (++action.n == 1) action.running = running(node, a);
      const std::size_t count = action.children.size();
      const double wanted = beliefs_of_one_visit * std::pow(action.n, belief_widening);
      if (count >= wanted || (is_full() && count > 0)) {
        node = action.children[action.n % count];
        continue;
      }
      if (is_full() || !draw_child(node, a, left - 1, random)) break;
      node = actions_of(node)[a].children.back();
      if (nodes_[node].times == 1) break;
    }
    for (std::size_t i = visits_.size(); i-- > 0;) back_up(i);
  }

  // The probability that the mission goes on after an action.
  double running(std::uint32_t node, std::size_t a) const {
    double sum = 0;
    double total = 0;
    for (std::size_t i = nodes_[node].first; i < nodes_[node].last; ++i) {
      const auto& [state, weight] = states_[i];
      for (const auto& outcome : space_.rows().outcomes[space_.rows().row(state, a)]) sum += weight * outcome.probability;
      total += weight;
    }
    return sum / total;
  }

  // Draws what is observed after an action. The belief after it is the last child then; none if the mission has ended.
  bool draw_child(std::uint32_t node, std::size_t a, int left, Sampler& random) {
    const std::span states{states_.data() + nodes_[node].first, states_.data() + nodes_[node].last};
    const bool goes_on = next_.draw(states, a, node == 0, random);
    work_ += per_outcome * next_.work();
    if (!goes_on) return false;
    const auto [like, share] = most_like();
    next_.keep(random);
    const List<std::uint32_t>& known = actions_of(node)[a].children;
    const BeliefKey key = key_of(next_.after());
    const auto same = std::ranges::find_if(known, [&](std::uint32_t child) { return nodes_[child].key == key; });
    const bool is_new = same == known.end();
    const std::uint32_t child = is_new ? add_node(next_.after(), left) : *same;
    if (is_new) {
      nodes_[child].like = like;
      nodes_[child].share = share;
    }
    ++nodes_[child].times;
    actions_of(node)[a].children.push_back(child);
    return true;
  }

  // The belief of the simulation that the drawn one has the largest share of.
  std::pair<std::uint32_t, double> most_like() {
    std::pair<std::uint32_t, double> most{no_node, 0};
    for (std::size_t i = visits_.size(); i-- > 0;) {
      const Node& node = nodes_[visits_[i].node];
      const bool is_last = i + 1 == visits_.size();
      const double share = next_.share_of(is_last ? std::span{next_.before()} : std::span{states_.data() + node.first, node.last - node.first});
      if (share > most.second) most = {visits_[i].node, share};
    }
    return most;
  }

  // Differences of weights that come from rounding do not count.
  static BeliefKey key_of(const SmallBelief& belief) {
    constexpr float unit = 1e5f;
    BeliefKey key;
    for (const auto& [state, weight] : belief) key.add(state, std::lround(unit * weight));
    return key;
  }

  void back_up(std::size_t i) {
    const auto [number, a] = visits_[i];
    renew(number, a);
    // Where beliefs after the best action lose what this one loses, its value falls with this one's.
    for (int rounds = 0; rounds < most_rounds; ++rounds) {
      const double before = nodes_[number].value;
      const ActionNode& best = best_action(number);
      nodes_[number].value = best.q;
      if (best.q >= before - settled * std::abs(before)) break;
      renew(number, &best - actions_of(number).data());
    }
  }

  // Takes an action's value anew from the beliefs after it.
  void renew(std::uint32_t number, std::size_t a) {
    ActionNode& action = actions_of(number)[a];
    if (action.children.empty()) return;
    const auto count = static_cast<double>(action.children.size());
    double sum = 0;
    double squares = 0;
    for (const std::uint32_t child : action.children) {
      const double value = value_of(child);
      sum += value;
      squares += value * value;
    }
    action.mean = sum / count;
    action.squares = std::max(squares / count - action.mean * action.mean, 0.0);
    action.q = action.reward + Model::discount * action.running * action.mean;
    work_ += action.children.size();
  }

  // What a belief is worth: no more than if it loses what it must.
  double value_of(std::uint32_t number) const {
    const Node& node = nodes_[number];
    if (node.like == no_node) return node.value;
    const Node& like = nodes_[node.like];
    return std::min(node.value, node.seen - node.share * std::max(like.seen - like.value, 0.0));
  }

  // The best action with enough visits.
  const ActionNode& best_action(std::uint32_t node) {
    std::uint32_t most = 0;
    for (const ActionNode& action : actions_of(node)) most = std::max(most, action.n);
    const ActionNode* best = nullptr;
    for (std::size_t a = 0; a < space_.actions(); ++a) {
      const ActionNode& action = actions_of(node)[a];
      if (is_barred(node, a) || (most > 0 && !is_well_visited(action.n, most))) continue;
      if (best == nullptr || action.q > best->q) best = &action;
    }
    return best != nullptr ? *best : actions_of(node).front();
  }

  // The variance of what an action is worth after one observation.
  static double variance(const ActionNode& action) {
    const double later = Model::discount * action.running;
    return later * later * action.squares;
  }

  // The action with the highest upper confidence bound; see exploration.hpp.
  std::size_t choose(std::uint32_t node) {
    double squares = 0;
    double visits = 0;
    for (const ActionNode& action : actions_of(node)) {
      squares += action.n * variance(action);
      visits += action.n;
    }
    const double spread = visits > 0 ? squares / visits : 0;
    const double root_n = std::sqrt(nodes_[node].n + 1.0);
    std::size_t best = 0;
    double best_bound = -std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < space_.actions(); ++a) {
      if (is_barred(node, a)) continue;
      const ActionNode& action = actions_of(node)[a];
      const double n = std::max<double>(action.n, 1);
      const double own = (action.n * variance(action) + prior_visits * spread) / (action.n + prior_visits);
      const double bound = action.q + std::sqrt(own * root_n / n);
      if (bound > best_bound) {
        best_bound = bound;
        best = a;
      }
    }
    return best;
  }

  const StateSpace<Model>& space_;
  MdpValues<Model>& values_;
  SensingTables<Model> tables_{space_};
  SensedBelief<Model> next_{space_, tables_};
  SmallBelief root_;
  int horizon_ = 0;
  BarredActions barred_;
  Operations work_ = 0;
  List<Node> nodes_;
  List<ActionNode> actions_;  // of the nodes in turn
  SmallBelief states_;               // of the nodes in turn
  List<Visit> visits_;        // of the simulation that runs
};

}
