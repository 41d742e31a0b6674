// One thread's search: simulations from the root of a tree, by upper confidence bounds (see pomcp.hpp for the whole).
//
// Letters: s state, a action, o observation, r reward, n visits, q value of an action, v value of a history.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "aos/base/observed_numbers.hpp"
#include "aos/base/random.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/observation_cells.hpp"
#include "aos/planning/search_tree.hpp"

namespace aos {

inline constexpr double prior_visits = 4;  // what a spread seen elsewhere counts for, in an action's own
inline constexpr std::uint32_t settled_visits = 16;
inline constexpr std::uint32_t well_visited_share = 4;  // at least 1/4 of the most visited action's visits
inline constexpr std::uint64_t turns = 8;
inline constexpr double even_share = 0.1;  // of the exploration, that does not follow the rollout policy
inline constexpr double usual_share = 0.9;  // of an action that rollouts prefer no less than others, but for rounding

// Whether an action was simulated often enough beside the most visited one for its value to be believed.
inline bool is_well_visited(std::uint32_t n, std::uint32_t most) {
  return static_cast<std::uint64_t>(n) * well_visited_share >= most && n > 0;
}

template <class Model>
class TreeSearch {
 public:
  // Takes no more than `bytes` for its tree, and for a copy of what is kept of it when a step is taken.
  explicit TreeSearch(std::size_t bytes)
      : tree_(Model::action_count(), bytes / 2), spare_(Model::action_count(), bytes / 2) {
    forget();
  }

  // Begins a decision. `prior` is how much less each action is worth than the best one, as far as can be said before; empty
  // where nothing can. The root's `barred` actions are not tried.
  void begin(int horizon, const std::vector<double>& prior, const BarredActions& barred) {
    horizon_ = horizon;
    barred_ = barred;
    prior_ = prior;
    rewards_.assign(action_count(), {});
    lowest_ = std::numeric_limits<double>::infinity();
    highest_ = -lowest_;
  }

  // One simulation from a running state, as of simulated_state.hpp, which goes on with it. `first` is the first action; -1
  // leaves it to the search.
  template <class SimulatedState>
  void simulate(SimulatedState& state, int first, Sampler& random) {
    if (!give_actions(0, state, random)) return;
    if (++simulations_ % renewal == 0 || simulations_ == settled_visits) renew_spread();
    if (first < 0 && simulations_ % turns == 0) {
      first = static_cast<int>(simulations_ / turns % static_cast<std::uint64_t>(Model::action_count()));
      if (barred_.has(static_cast<std::size_t>(first))) first = -1;
    }
    const double seen = descend(state, first < 0 ? choose(0) : static_cast<std::uint32_t>(first), random);
    lowest_ = std::min(lowest_, seen);
    highest_ = std::max(highest_, seen);
    const double deviation = seen - mean_;
    mean_ += deviation / static_cast<double>(simulations_);
    squares_ += deviation * (seen - mean_);
  }

  // What is known about a root action: value, simulations, and the variance of one. Values are relative to those of the
  // states, where these are known.
  struct Known {
    double q = 0;
    std::uint32_t n = 0;
    double variance = 0;
    double reward = 0;  // earned at once, in this decision's simulations
  };
  Known known(int action) const {
    if (tree_.history(0).first_action == no_node) return {};
    const ActionNode& node = tree_.actions(tree_.history(0))[action];
    const auto& [sum, n] = rewards_[static_cast<std::size_t>(action)];
    return {node.q, node.n, node.n > 1 ? std::max(node.squares / (node.n - 1), 0.0) : 0, n > 0 ? sum / n : 0};
  }

  std::uint32_t known_simulations() const { return tree_.history(0).n; }

  // Whether so many more simulations of any other action could not lift its value, and of the best one not lower it, to
  // where they meet, were they as good and as bad as the extremes seen.
  bool is_decided(double more) const {
    const HistoryNode& root = tree_.history(0);
    if (root.first_action == no_node || root.n < settled_visits || barred_.has(root.best)) return false;
    const ActionNode* const actions = tree_.actions(root);
    const auto moved = [&](const ActionNode& node, double to) { return (node.n * node.q + more * to) / (node.n + more); };
    const double least = moved(actions[root.best], lowest_);
    for (std::uint32_t a = 0; a < action_count(); ++a) {
      if (a != root.best && !barred_.has(a) && moved(actions[a], highest_) >= least) return false;
    }
    return true;
  }

  // Keeps what is known below the action and observation; nothing where that was never simulated, or where numbers were
  // observed, whose cell says less than they do.
  void move_to(int action, Observation observation) {
    if (reports_numbers_) return forget();
    const HistoryNode& root = tree_.history(0);
    const std::uint32_t kept =
        root.first_action == no_node
            ? no_node
            : tree_.find_child(root.first_action + static_cast<std::uint32_t>(action), observation);
    if (kept == no_node) return forget();
    spare_.copy_subtree(tree_, kept);
    std::swap(tree_, spare_);
    spare_.clear();
    forget_spread();
  }

  void forget() {
    tree_.clear();
    cells_.clear();
    forget_spread();
  }

 private:
  static constexpr std::uint64_t renewal = 256;

  struct Visit {
    std::uint32_t history;
    std::uint32_t action;
    double reward;
  };

  static std::uint32_t action_count() { return static_cast<std::uint32_t>(Model::action_count()); }

  void forget_spread() {
    simulations_ = 0;
    mean_ = 0;
    squares_ = 0;
    spread_ = 0;
  }

  // The variance of the best root action's returns, or of all returns while that is unknown.
  void renew_spread() {
    const HistoryNode& root = tree_.history(0);
    const ActionNode& best = tree_.actions(root)[root.best];
    spread_ = best.n >= settled_visits ? best.squares / best.n : squares_ / static_cast<double>(simulations_);
  }

  // Goes down to a history that is new, or to an end, and back up. Returns the discounted return.
  template <class SimulatedState>
  double descend(SimulatedState& state, std::uint32_t a, Sampler& random) {
    visits_.clear();
    std::uint32_t history = 0;
    int left = horizon_;
    double value = state.value(left);
    double later = 0;
    double change = 0;  // of n * v of the history that the last action led to
    ObservationCells::Drawn drawn{random};
    while (true) {
      const Step step = step_of(state, static_cast<int>(a), random, drawn);
      if (visits_.empty()) add_reward(a, step.reward);
      const bool goes_on = --left > 0 && !state.has_ended();
      const double before = value;
      value = goes_on ? state.value(left) : 0;
      visits_.push_back({history, a, step.reward + Model::discount * value - before});
      if (!goes_on) break;

      const std::uint32_t action = tree_.history(history).first_action + a;
      const Observation seen = reports_numbers_ ? cells_.cell(action, step.observation, drawn) : step.observation;
      std::uint32_t child = tree_.find_child(action, seen);
      const bool is_new = child == no_node;
      if (is_new) child = tree_.add_child(action, seen);
      if (is_new || stays_leaf(child) || !give_actions(child, state, random)) {
        later = state.leaf(left, random);
        change = child == no_node ? later : add_return(tree_.history(child), later);
        break;
      }
      history = child;
      a = choose(history);
    }
    for (std::size_t i = visits_.size(); i-- > 0;) {
      later = visits_[i].reward + Model::discount * later;
      change = back_up(visits_[i], change, later);
    }
    return later;
  }

  // What the step reports is drawn, too.
  template <class SimulatedState>
  Step step_of(SimulatedState& state, int action, Sampler& random, ObservationCells::Drawn& drawn) const {
    if (!reports_numbers_) return state.step(action, random);
    drawn.clear();
    const ReportingTo reporting{random, drawn};
    return state.step(action, random);
  }

  // With a prior a history stays a leaf until it has been visited as often as there are actions. What states are worth to
  // somebody who sees them is too much, and less so the deeper the tree: few visits below each of many actions would
  // tell them apart by how deep these happened to go.
  bool stays_leaf(std::uint32_t number) const {
    const HistoryNode& history = tree_.history(number);
    return !prior_.empty() && history.first_action == no_node && history.n < action_count();
  }

  // Returns false where there is no room for them. Where play-outs value new histories, actions that these would take from
  // the state have most of the exploration: the others are not to use up the few visits of a history.
  template <class SimulatedState>
  bool give_actions(std::uint32_t number, const SimulatedState& state, Sampler& random) {
    const bool is_new = tree_.history(number).first_action == no_node;
    if (!tree_.give_actions(number)) return false;
    odds_.resize(action_count());
    if (!is_new || !state.rollout_odds(odds_.data(), random)) return true;
    ActionNode* const actions = tree_.actions(tree_.history(number));
    for (std::uint32_t a = 0; a < action_count(); ++a) {
      actions[a].share = even_share + (1 - even_share) * odds_[a] * action_count();
    }
    return true;
  }

  // Of a history without actions. Returns the change of n * v.
  static double add_return(HistoryNode& node, double seen) {
    ++node.n;
    node.v += (seen - node.v) / node.n;
    return seen;
  }

  // Returns the change of n * v of the history. As often as a step, and so without a call, as is `choose`.
  [[gnu::always_inline]] double back_up(const Visit& visit, double change, double seen) {
    HistoryNode& parent = tree_.history(visit.history);
    ActionNode* const actions = tree_.actions(parent);
    ActionNode& node = actions[visit.action];
    const double q_before = node.q;
    ++node.n;
    node.rewards += visit.reward;
    node.continuations += change;
    node.q = (node.rewards + Model::discount * node.continuations) / node.n;
    const double deviation = seen - node.mean;
    node.mean += deviation / node.n;
    const double square = deviation * (seen - node.mean);
    node.squares += square;
    parent.squares += square;
    parent.max_visits = std::max(parent.max_visits, node.n);
    renew_best(parent, actions, visit.action, node.q < q_before);

    const double before = parent.n * parent.v;
    ++parent.n;
    parent.v = parent.n < settled_visits ? parent.v + (seen - parent.v) / parent.n : actions[parent.best].q;
    return parent.n * parent.v - before;
  }

  // After a change of one action.
  static void renew_best(HistoryNode& parent, const ActionNode* actions, std::uint32_t changed, bool has_fallen) {
    const bool is_best = changed == parent.best;
    if ((is_best && has_fallen) || !is_well_visited(actions[parent.best].n, parent.max_visits)) {
      parent.best = changed;
      for (std::uint32_t a = 0; a < action_count(); ++a) take_better(parent, actions, a);
    } else if (!is_best) {
      take_better(parent, actions, changed);
    }
  }
  static void take_better(HistoryNode& parent, const ActionNode* actions, std::uint32_t a) {
    const bool is_better = actions[a].q > actions[parent.best].q || !is_well_visited(actions[parent.best].n, parent.max_visits);
    if (is_better && is_well_visited(actions[a].n, parent.max_visits)) parent.best = a;
  }

  void add_reward(std::uint32_t a, double reward) {
    auto& [sum, n] = rewards_[a];
    sum += reward;
    n += 1;
  }

  // The highest upper confidence bound. Without a prior, every action with a usual share comes once first, at the root every
  // one. An action's spread is its own, and as if `prior_visits` more had the spread of all actions here, which is in
  // the same way filled up with the root's. What was never tried counts as what its history is worth, less what the
  // prior says, seen once.
  [[gnu::always_inline]] std::uint32_t choose(std::uint32_t number) const {
    const HistoryNode& history = tree_.history(number);
    const ActionNode* const actions = tree_.actions(history);
    const double root_n = std::sqrt(static_cast<double>(history.n) + 1);
    const double prior = prior_visits * (history.squares + prior_visits * spread_) / (history.n + prior_visits);
    std::uint32_t best = 0;
    double best_bound = -std::numeric_limits<double>::infinity();
    for (std::uint32_t a = 0; a < action_count(); ++a) {
      const ActionNode& node = actions[a];
      if (number == 0 && barred_.has(a)) continue;
      if (node.n == 0 && prior_.empty() && (node.share >= usual_share || number == 0)) return a;
      const double n = std::max<double>(node.n, 1);
      const double squares = (node.squares + prior) * node.share;
      const double value = node.n > 0 ? node.q : history.v - (prior_.empty() ? 0 : prior_[a]);
      const double bound = value + std::sqrt(squares * root_n / ((n + prior_visits) * n));
      if (bound > best_bound) {
        best_bound = bound;
        best = a;
      }
    }
    return best;
  }

  SearchTree tree_;
  SearchTree spare_;
  bool reports_numbers_ = Model::reports_numbers();
  ObservationCells cells_;
  int horizon_ = 0;
  BarredActions barred_;
  std::vector<Visit> visits_;
  std::vector<double> odds_;
  std::vector<double> prior_;
  std::vector<std::pair<double, double>> rewards_;  // of the root's actions in this decision: their sum, and how many
  std::uint64_t simulations_ = 0;
  double mean_ = 0;  // of all returns, with their
  double squares_ = 0;
  double spread_ = 0;
  double lowest_ = 0;
  double highest_ = 0;
};

}  // namespace aos
