// The memory of a search tree: histories, and the actions that were tried after each of them.
//
// Nodes lie in two lists, and their indices name them. The children of an action are a linked list while they are few; longer
// lists are indexed by one hash table. A history gets its actions at its second visit, since most are visited once. When the
// memory is used up, the tree stops growing and goes on learning. Letters: n visits, q value of an action, v value of a history.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/base/number_index.hpp"
#include "aos/base/list.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"

namespace aos {

inline constexpr std::uint32_t max_listed_children = 4;

struct HistoryNode {
  Observation observation = default_observation;
  double v = 0;
  double squares = 0;  // sum of its actions' squares
  std::uint32_t n = 0;
  std::uint32_t max_visits = 0;  // the most visits of one of its actions
  std::uint32_t parent = no_node;  // the action that leads here
  std::uint32_t sibling = no_node;
  std::uint32_t first_action = no_node;
  std::uint32_t best = 0;  // the best action among the well visited ones
};

// A choice looks at all actions of a history: each is one line of the processor's cache.
struct alignas(64) ActionNode {
  union {
    double q;                // the value, from the first visit on
    double advantage = 0;    // before it: what the action is worth beyond its history, if known
  };
  double rewards = 0;        // sum of immediate rewards
  double continuations = 0;  // sum over children of n * v
  double mean = 0;           // of the sampled returns
  double squares = 0;        // sum of the returns' squared deviations from their mean
  double share = 1;          // of the exploration; 1 is an even share
  std::uint32_t n = 0;
  std::uint32_t first_child = no_node;
  std::uint32_t children = 0;
};

class SearchTree {
 public:
  // What an action tells, in nats. Known where information has a price.
  struct Told {
    double doubt = 0;  // sum over visits of what the observation leaves open in a known state
    double information = 0;
  };

  // The nodes take at most `bytes`. The operating system provides memory as nodes use it.
  SearchTree(int action_count, std::size_t bytes) : action_count_(static_cast<std::uint32_t>(action_count)) {
    histories_.reserve(bytes / 4 / sizeof(HistoryNode));
    actions_.reserve(bytes / 4 * 3 / (sizeof(ActionNode) + sizeof(Told)));
    clear();
  }

  // Removes all nodes and adds an empty root, number 0.
  void clear() {
    histories_.clear();
    actions_.clear();
    told_.clear();
    index_ = {};
    histories_.push_back({});
  }

  HistoryNode& history(std::uint32_t number) { return histories_[number]; }
  const HistoryNode& history(std::uint32_t number) const { return histories_[number]; }
  // The actions of a history that has them, as an array.
  ActionNode* actions(const HistoryNode& history) { return actions_.data() + history.first_action; }
  const ActionNode* actions(const HistoryNode& history) const { return &actions_[history.first_action]; }
  ActionNode& action(std::uint32_t number) { return actions_[number]; }
  Told& told(const ActionNode& action) {
    if (told_.size() < actions_.size()) {
      told_.reserve(actions_.capacity());
      told_.resize(actions_.size());
    }
    return told_[&action - actions_.data()];
  }
  std::size_t size() const { return histories_.size(); }

  // Gives a history its actions. Returns false if there is no room for them.
  bool give_actions(std::uint32_t number) {
    if (histories_[number].first_action != no_node) return true;
    if (!actions_.has_room(action_count_)) return false;
    histories_[number].first_action = actions_.size();
    actions_.resize(actions_.size() + action_count_);
    return true;
  }

  // The history after an action and an observation, or `no_node`.
  [[gnu::always_inline]] std::uint32_t find_child(std::uint32_t action, Observation observation) const {
    const ActionNode& parent = actions_[action];
    if (parent.children > max_listed_children) {
      return index_.find(mixed(action, observation), [&](std::uint32_t child) {
        return histories_[child].parent == action && histories_[child].observation == observation;
      });
    }
    std::uint32_t child = parent.first_child;
    while (child != no_node && histories_[child].observation != observation) child = histories_[child].sibling;
    return child;
  }

  // Adds a history after an action. Returns `no_node` if there is no room for it.
  std::uint32_t add_child(std::uint32_t action, Observation observation) {
    if (!histories_.has_room(1)) return no_node;
    const std::uint32_t number = histories_.size();
    histories_.push_back({.observation = observation});
    hang(action, number);
    return number;
  }

  // Replaces this tree by the part of another one below a history, which becomes the root.
  void copy_subtree(const SearchTree& from, std::uint32_t root) {
    clear();
    copy_node(from, root, 0);
    for (std::uint32_t copied = 0; copied < histories_.size(); ++copied) {
      if (histories_[copied].first_action == no_node) continue;
      const ActionNode* const originals = from.actions(from.histories_[sources_[copied]]);
      for (std::uint32_t a = 0; a < action_count_; ++a) {
        for (std::uint32_t child = originals[a].first_child; child != no_node; child = from.histories_[child].sibling) {
          const std::uint32_t number = histories_.size();
          histories_.push_back({});
          copy_node(from, child, number);
          hang(histories_[copied].first_action + a, number);
        }
      }
    }
    sources_.clear();
  }

 private:
  void hang(std::uint32_t action, std::uint32_t child) {
    ActionNode& parent = actions_[action];
    histories_[child].parent = action;
    histories_[child].sibling = std::exchange(parent.first_child, child);
    if (++parent.children < max_listed_children + 1) return;
    if (parent.children > max_listed_children + 1) return add_to_index(action, child);
    for (; child != no_node; child = histories_[child].sibling) add_to_index(action, child);
  }

  // Copies a history with its actions, without their children and without the history's place in the tree.
  void copy_node(const SearchTree& from, std::uint32_t original, std::uint32_t copy) {
    sources_.push_back(original);
    const HistoryNode& node = from.histories_[original];
    histories_[copy] = node;
    histories_[copy].sibling = no_node;
    histories_[copy].first_action = no_node;
    if (node.first_action == no_node || !give_actions(copy)) return;
    for (std::uint32_t a = 0; a < action_count_; ++a) {
      ActionNode& action = actions_[histories_[copy].first_action + a] = from.actions(node)[a];
      if (node.first_action + a < from.told_.size()) told(action) = from.told_[node.first_action + a];
      action.first_child = no_node;
      action.children = 0;
    }
  }

  void add_to_index(std::uint32_t action, std::uint32_t child) {
    const auto is_new = [](std::uint32_t) { return false; };
    index_.find_or_add(mixed(action, histories_[child].observation), child, is_new);
  }

  std::uint32_t action_count_;
  List<HistoryNode> histories_;
  List<ActionNode> actions_;
  List<Told> told_;  // by action
  NumberIndex index_;
  List<std::uint32_t> sources_;  // while copying: the original of each history
};

}
