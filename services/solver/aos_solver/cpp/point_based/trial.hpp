// Trials: paths from a belief into the graph, along which actions are opened.
#pragma once

#include "aos/base/switches.hpp"
#include "point_based/backups.hpp"
#include "point_based/belief_graph.hpp"
#include "point_based/constants.hpp"
#include "point_based/online.hpp"

namespace aos::point_based {

// Runs one trial at a time. A trial returns whether it has opened an action, and it leaves its path.
class Trial {
 public:
  Trial(const FlatModel& model, BeliefGraph& graph, Backups& backups)
      : model_(model), graph_(graph), backups_(backups), begun_(model.actions) {}

  // The nodes of the last trial, from its start on.
  const List<std::uint32_t>& path() const { return path_; }
  // How many sampled trials began with each action.
  const List<std::uint32_t>& begun() const { return begun_; }
  void set_begun(List<std::uint32_t> begun) { begun_ = std::move(begun); }
  void forget_begun() { begun_.assign(model_.actions, 0); }
  // Begins again with the upper bound.
  void start_over() { sampled_ = 0; }

  // Repeats an action, with the likeliest observation each time, as long as it may be the best and leads on.
  bool persist(std::uint32_t number, std::uint32_t action, Asked is_over) {
    begin();
    while (path_.size() < longest_detour) {
      Node& node = graph_[number];
      graph_.expand(node);
      Branch* const branch = node.branch_of(action);
      if (branch == nullptr) break;
      path_.push_back(number);
      if (!branch->is_open) has_learnt_ = true;
      graph_.open(node, *branch);
      backups_.refresh(*branch);
      const auto likeliest = std::ranges::max_element(branch->successors, {}, &Successor::probability);
      if (likeliest == branch->successors.end() || likeliest->node == number || is_over()) break;
      number = likeliest->node;
    }
    return has_learnt_;
  }

  // Follows the upper bound or, every third time, the lower one, towards the gap that matters most at the root.
  bool sample(std::uint32_t number, double precision, Asked is_over) {
    begin();
    const bool by_lower = switches::lower_trials && sampled_++ % 3 == 2;
    const double gap = graph_[number].upper - graph_[number].lower;
    double allowed = std::max(precision, share_of_gap * gap);
    double low = graph_[number].lower;
    double high = low + allowed;
    const std::size_t longest = path_.size() + longest_trial;
    while (path_.size() < longest) {
      Node& node = graph_[number];
      graph_.refresh_lower(node);
      graph_.refresh_upper(node);
      if (node.upper <= low && node.upper <= std::max(high, node.lower + allowed)) break;
      path_.push_back(number);
      graph_.expand(node);
      if (is_over()) break;
      const Branch* const best = followed_branch(node, by_lower, is_over);
      if (best == nullptr) break;
      const double best_lower = std::ranges::max_element(node.branches, {}, &Branch::lower)->lower;
      if (path_.size() == 1) ++begun_[best->action];
      low = std::max(low, best_lower);
      high = std::max(high, best_lower + allowed);
      allowed /= model_.discount;
      const Successor* next = widest_of(best->successors, allowed);
      if (next == nullptr) break;
      double other_lower = best->reward;
      double other_upper = best->reward;
      for (const Successor& successor : best->successors) {
        if (&successor == next) continue;
        other_lower += model_.discount * successor.probability * graph_[successor.node].lower;
        other_upper += model_.discount * successor.probability * graph_[successor.node].upper;
      }
      low = (low - other_lower) / (model_.discount * next->probability);
      high = (high - other_upper) / (model_.discount * next->probability);
      number = next->node;
    }
    return has_learnt_;
  }

  // The successor whose gap exceeds `allowed` by most, weighted by its probability; null if there is none.
  const Successor* widest_of(const List<Successor>& successors, double allowed) {
    const Successor* widest = nullptr;
    double widest_excess = 0;
    for (const Successor& successor : successors) {
      const Node& node = graph_[successor.node];
      const double excess = successor.probability * (node.upper - node.lower - allowed);
      if (widest != nullptr && excess <= widest_excess) continue;
      widest = &successor;
      widest_excess = excess;
    }
    return widest;
  }

 private:
  void begin() {
    path_.clear();
    has_learnt_ = false;
  }

  // The best of the open branches by one of the bounds. By the lower one all are opened; else the one with the highest upper
  // bound is. Refreshes the bounds of open branches. Null if `is_over()` comes first.
  const Branch* followed_branch(Node& node, bool by_lower, Asked is_over) {
    for (Branch& branch : node.branches) {
      if (by_lower && !branch.is_open && !is_over()) {
        graph_.open(node, branch);
        has_learnt_ = true;
      }
      if (branch.is_open) backups_.refresh(branch);
    }
    while (!node.branches.empty()) {
      Branch* highest = &node.branches.front();
      Branch* followed = nullptr;
      for (Branch& branch : node.branches) {
        if (branch.upper > highest->upper) highest = &branch;
        if (branch.is_open && (followed == nullptr || merit(branch, by_lower) > merit(*followed, by_lower))) followed = &branch;
      }
      if (highest->is_open) return followed;
      graph_.open(node, *highest);
      backups_.refresh(*highest);
      has_learnt_ = true;
      if (is_over()) break;
    }
    return nullptr;
  }

  static double merit(const Branch& branch, bool by_lower) { return by_lower ? branch.lower : branch.upper; }

  const FlatModel& model_;
  BeliefGraph& graph_;
  Backups& backups_;
  List<std::uint32_t> path_;
  List<std::uint32_t> begun_;
  std::uint64_t sampled_ = 0;
  bool has_learnt_ = false;
};

}
