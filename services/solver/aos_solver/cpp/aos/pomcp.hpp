// POMCP (Silver and Veness, 2010): Monte-Carlo tree search over histories, from an exact root belief.
//
// What differs from the paper, and why:
// - The exploration bonus follows the returns that are seen: immediate rewards say little about their spread, and a
//   constant that is too small is the commonest way for POMCP to fail. It falls polynomially, not logarithmically, as
//   values that drift while the tree below them grows need (Shah, Xie and Xu, 2020).
// - Every second simulation takes the root's actions in turn, so that the values of all of them are worth reading.
// - Where the states are few, a leaf is worth what it would be to somebody who sees the state (full_knowledge.hpp);
//   elsewhere it is worth a rollout.
// - Values are backed up through the most visited action, not as the mean of all simulations, which the exploring ones
//   pull down.
// - After a real step the subtree below (action, observation) is kept and looks the full horizon ahead again.
//
// Letters: s state, a action, o observation, r reward, n visits, q value of an action, v value of a history.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "aos/belief.hpp"
#include "aos/clock.hpp"
#include "aos/full_knowledge.hpp"
#include "aos/random.hpp"
#include "aos/step.hpp"

namespace aos {

inline constexpr double exploration = 0.15;
inline constexpr std::uint32_t settled_visits = 16;
inline constexpr std::size_t most_nodes = 8'000'000;
inline constexpr std::uint32_t no_node = 0xffffffffu;

struct Budget {
  std::uint64_t simulations = 0;  // 0: no limit
  double seconds = 0;             // 0: no limit
};

struct ActionEstimate {
  double q = 0;
  std::uint32_t n = 0;
  double standard_error = 0;
};

template <class Model>
class Pomcp {
 public:
  using State = typename Model::State;

  Pomcp() { forget(); }

  // Runs the search and returns how many simulations it took.
  std::uint64_t search(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random) {
    using Clock = PlanningClock;
    const Clock::time_point start = Clock::now();
    const auto after = [&](double seconds) {
      return start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    };
    const Clock::time_point end = budget.seconds > 0 ? after(budget.seconds) : Clock::time_point::max();
    const Clock::time_point half = budget.seconds > 0 ? after(budget.seconds / 2) : Clock::time_point::max();
    has_knowledge_ = knowledge_.prepare(belief, horizon, half);
    std::uint64_t done = 0;
    while (budget.simulations == 0 || done < budget.simulations) {
      if (done % 64 == 0 && Clock::now() >= end) break;
      State state = belief.sample(random);
      ++done;
      if (Model::ending(state) != Ending::running) continue;
      const int in_turn = static_cast<int>(done / 2 % static_cast<std::uint64_t>(Model::action_count()));
      const int first = done % 2 == 0 ? in_turn : choose(0);
      const double seen = simulate(state, 0, first, horizon, random);
      lowest_ = std::min(lowest_, seen);
      highest_ = std::max(highest_, seen);
    }
    return done;
  }

  // For each action; values are over the whole belief, so that its ended part counts as nothing to gain.
  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    std::vector<ActionEstimate> result(static_cast<std::size_t>(Model::action_count()));
    const double running = belief.probability_of(Ending::running);
    for (int a = 0; a < Model::action_count(); ++a) {
      const ActionNode& node = action(0, a);
      if (node.n == 0) continue;
      const double variance = node.n > 1 ? std::max(node.squares / (node.n - 1), 0.0) : 0;
      result[static_cast<std::size_t>(a)] = {running * node.q, node.n, running * std::sqrt(variance / node.n)};
    }
    return result;
  }

  // Keeps what is known below the action and observation; nothing where that was never simulated.
  void move_to(int a, Observation o) {
    const std::uint32_t kept = find_child(action(0, a), o);
    if (kept == no_node) {
      forget();
      return;
    }
    std::vector<HistoryNode> histories;
    std::vector<ActionNode> actions;
    copy_subtree(kept, histories, actions);
    histories_ = std::move(histories);
    actions_ = std::move(actions);
  }

  void forget() {
    histories_.clear();
    actions_.clear();
    lowest_ = std::numeric_limits<double>::infinity();
    highest_ = -lowest_;
    add_history(default_observation);
  }

 private:
  struct HistoryNode {
    Observation observation;
    std::uint32_t first_action;
    std::uint32_t sibling;
    std::uint32_t n;
    double v;
  };
  struct ActionNode {
    double q = 0;
    double rewards = 0;          // sum of immediate rewards
    double continuations = 0;    // sum over children of n * v
    double mean = 0;             // of the sampled returns, with their
    double squares = 0;          // sum of squared deviations
    std::uint32_t n = 0;
    std::uint32_t first_child = no_node;
  };

  const ActionNode& action(std::uint32_t history, int a) const {
    return actions_[histories_[history].first_action + static_cast<std::uint32_t>(a)];
  }
  ActionNode& action(std::uint32_t history, int a) {
    return actions_[histories_[history].first_action + static_cast<std::uint32_t>(a)];
  }

  std::uint32_t add_history(Observation o) {
    const auto number = static_cast<std::uint32_t>(histories_.size());
    histories_.push_back({o, static_cast<std::uint32_t>(actions_.size()), no_node, 0, 0});
    actions_.resize(actions_.size() + static_cast<std::size_t>(Model::action_count()));
    return number;
  }

  std::uint32_t find_child(const ActionNode& parent, Observation o) const {
    std::uint32_t child = parent.first_child;
    while (child != no_node && histories_[child].observation != o) child = histories_[child].sibling;
    return child;
  }

  // One descent from a history, whose first action is `a`: returns the discounted return of this simulation.
  double simulate(State& state, std::uint32_t history, int a, int horizon, Sampler& random) {
    const Step step = Model::step(state, a, random);
    const bool goes_on = horizon > 1 && Model::ending(state) == Ending::running;

    double later = 0;
    double change = 0;  // of n * v of the child
    if (goes_on) {
      std::uint32_t child = find_child(action(history, a), step.observation);
      if (child == no_node && histories_.size() < most_nodes) {
        child = add_history(step.observation);
        ActionNode& parent = action(history, a);
        histories_[child].sibling = std::exchange(parent.first_child, child);
        later = leaf_value(state, horizon - 1, random);
        histories_[child].n = 1;
        histories_[child].v = later;
        change = later;
      } else if (child == no_node) {
        later = leaf_value(state, horizon - 1, random);
        change = later;
      } else {
        const double before = histories_[child].n * histories_[child].v;
        later = simulate(state, child, choose(child), horizon - 1, random);
        change = histories_[child].n * histories_[child].v - before;
      }
    }
    const double seen = step.reward + Model::discount * later;
    back_up(history, a, step.reward, change, seen);
    return seen;
  }

  void back_up(std::uint32_t history, int a, double reward, double change, double seen) {
    ActionNode& node = action(history, a);
    ++node.n;
    node.rewards += reward;
    node.continuations += change;
    node.q = (node.rewards + Model::discount * node.continuations) / node.n;
    const double deviation = seen - node.mean;
    node.mean += deviation / node.n;
    node.squares += deviation * (seen - node.mean);

    HistoryNode& parent = histories_[history];
    ++parent.n;
    if (parent.n < settled_visits) {
      parent.v += (seen - parent.v) / parent.n;
    } else {
      parent.v = action(history, most_visited(history)).q;
    }
  }

  int most_visited(std::uint32_t history) const {
    int best = 0;
    for (int a = 1; a < Model::action_count(); ++a) {
      if (action(history, a).n > action(history, best).n) best = a;
    }
    return best;
  }

  // The highest upper confidence bound; every action once first.
  int choose(std::uint32_t history) const {
    const double root_n = std::sqrt(static_cast<double>(histories_[history].n) + 1);
    const double constant = exploration * std::max(highest_ - lowest_, 1.0);
    int best = 0;
    double best_bound = -std::numeric_limits<double>::infinity();
    for (int a = 0; a < Model::action_count(); ++a) {
      const ActionNode& node = action(history, a);
      if (node.n == 0) return a;
      const double bound = node.q + constant * std::sqrt(root_n / node.n);
      if (bound > best_bound) {
        best_bound = bound;
        best = a;
      }
    }
    return best;
  }

  double leaf_value(State& state, int horizon, Sampler& random) const {
    return has_knowledge_ ? knowledge_.value(state, horizon) : Model::rollout(state, horizon, random);
  }

  std::uint32_t copy_subtree(std::uint32_t from, std::vector<HistoryNode>& histories,
                             std::vector<ActionNode>& actions) const {
    const auto number = static_cast<std::uint32_t>(histories.size());
    const auto first = static_cast<std::uint32_t>(actions.size());
    histories.push_back(histories_[from]);
    histories[number].first_action = first;
    histories[number].sibling = no_node;
    for (int a = 0; a < Model::action_count(); ++a) actions.push_back(action(from, a));
    for (int a = 0; a < Model::action_count(); ++a) {
      std::uint32_t last = no_node;
      for (std::uint32_t child = action(from, a).first_child; child != no_node; child = histories_[child].sibling) {
        const std::uint32_t copied = copy_subtree(child, histories, actions);
        (last == no_node ? actions[first + static_cast<std::uint32_t>(a)].first_child : histories[last].sibling) = copied;
        last = copied;
      }
    }
    return number;
  }

  std::vector<HistoryNode> histories_;
  std::vector<ActionNode> actions_;
  FullKnowledge<Model> knowledge_;
  bool has_knowledge_ = false;
  double lowest_ = 0;
  double highest_ = 0;
};

}  // namespace aos
