// Point-based value iteration near the beliefs that a good policy reaches (SARSOP: Kurniawati, Hsu and Lee, 2008).
//
// A trial follows the action with the highest upper bound and the observation that matters most for the gap at the
// root, until nothing more can be learnt for the root; then both bounds are backed up along the way. Every other trial
// follows the highest middle of both bounds instead: while upper bounds are far too high the best of them say little
// about what is worth improving, and the lower bound is what is carried out. Actions whose
// upper bound is below the belief's lower bound are dropped, and alpha vectors that are best at no remaining belief.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "point_based/belief_graph.hpp"
#include "point_based/online.hpp"

namespace aos::point_based {

class Sarsop {
 public:
  Sarsop(const FlatModel& model, const Regions& regions) : model_(model), regions_(regions), graph_(model, regions) {
    trials_.assign(model.actions, 0);
    for (const Start& start : model.starts) add_start(start);
  }

  // What a policy is sure to give from the start, and what none can give more than; discounted.
  double lower() { return over_roots(&Node::lower); }
  double upper() { return over_roots(&Node::upper); }
  std::size_t beliefs() const { return graph_.size(); }
  std::size_t bytes() const { return graph_.bytes(); }
  std::uint64_t backups() const { return backups_; }
  std::size_t vectors() const {
    std::size_t count = 0;
    for (std::uint32_t region = 0; region < regions_.all.size(); ++region) count += graph_.lower(region).kept();
    return count;
  }
  const LowerBound& lower_of(std::uint32_t region) const { return graph_.lower(region); }

  // Forgets all that trials have found out.
  void start_over() {
    roots_.clear();
    graph_.start_over();
    vectors_added_ = 0;
    sampled_ = 0;
  }

  // Goes on from another belief; all that is known of other beliefs is kept, of alpha vectors only if there is no room.
  void move_to(const Start& start, std::size_t most_bytes) {
    if (bytes() > most_bytes) {
      prune();
      graph_.forget_beliefs();
    }
    roots_.clear();
    trials_.assign(model_.actions, 0);
    add_start(start);
  }

  // One trial, with backups; it is cut short after `is_over()`. Returns how many states were backed up.
  template <class IsOver>
  std::uint64_t improve(double precision, IsOver&& is_over) {
    const Root* widest = nullptr;
    for (const Root& root : roots_) {
      if (widest == nullptr || weighted_gap(root) > weighted_gap(*widest)) widest = &root;
    }
    return widest == nullptr ? 0 : improve_from(widest->node, precision, is_over);
  }

  // The same below an action that is carried out at the only start.
  template <class IsOver>
  std::uint64_t improve_below(std::uint32_t action, double precision, IsOver&& is_over) {
    if (roots_.empty()) return 0;
    const Node& root = graph_[roots_.front().node];
    const Branch branch = graph_.branch(root, action, root.upper);
    refreshed_lower(branch);
    refreshed_upper(branch);
    const Successor* next = widest_of(branch.successors, precision);
    return next == nullptr ? 0 : improve_from(next->node, precision, is_over);
  }

  // Of all actions at the only start.
  std::vector<ActionBounds> action_bounds() {
    std::vector<ActionBounds> bounds(model_.actions);
    if (roots_.empty()) return bounds;
    const Node& root = graph_[roots_.front().node];
    const std::vector<double> informed = graph_.informed_values(root);
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      const Branch branch = graph_.branch(root, action, informed[action]);
      const double upper = std::min(branch.upper, refreshed_upper(branch));
      bounds[action] = {refreshed_lower(branch), upper, trials_[action]};
    }
    return bounds;
  }

  // Gives up alpha vectors that are the best at no belief that the remaining actions reach.
  void prune() {
    vectors_added_ = 0;
    std::vector<std::vector<bool>> is_best(regions_.all.size());
    for (std::uint32_t region = 0; region < is_best.size(); ++region) {
      is_best[region].resize(graph_.lower(region).size());
    }
    std::vector<bool> is_reached(graph_.size());
    std::vector<std::uint32_t> waiting;
    const auto reach = [&](std::uint32_t number) {
      if (is_reached[number]) return;
      is_reached[number] = true;
      waiting.push_back(number);
    };
    for (const Root& root : roots_) reach(root.node);
    while (!waiting.empty()) {
      Node& node = graph_[waiting.back()];
      waiting.pop_back();
      graph_.refresh_lower(node);
      is_best[node.region][node.vector] = true;
      for (const Branch& branch : node.branches) {
        for (const Successor& successor : branch.successors) reach(successor.node);
      }
    }
    for (std::uint32_t region = 0; region < regions_.all.size(); ++region) {
      LowerBound& bound = graph_.lower(region);
      for (std::uint32_t number = 0; number < bound.size(); ++number) {
        if (!is_best[region][number] && !bound[number].is_gone() && !bound[number].is_blind) bound.give_up(number);
      }
    }
  }

 private:
  struct Root {
    double weight;
    std::uint32_t node;
  };

  static constexpr double share_of_gap_ = 0.1;  // of the root's, that a trial tries to come below
  static constexpr std::size_t longest_trial_ = 1000;

  void add_start(const Start& start) {
    Belief belief;
    std::vector<std::pair<std::uint32_t, double>> entries;
    double total = 0;
    std::uint32_t region = nowhere;
    for (const auto& [state, probability] : start.belief) {
      if (regions_.region_of[state] == nowhere || probability <= 0) continue;
      region = regions_.region_of[state];
      entries.emplace_back(regions_.local_of[state], probability);
      total += probability;
    }
    if (region == nowhere) return;
    std::sort(entries.begin(), entries.end());
    for (const auto& [local, probability] : entries) {
      belief.states.push_back(local);
      belief.probabilities.push_back(probability / total);
    }
    roots_.push_back({start.weight * total, graph_.node_of(region, belief)});
  }

  template <class IsOver>
  std::uint64_t improve_from(std::uint32_t number, double precision, IsOver&& is_over) {
    sample(number, precision, is_over);
    std::uint64_t states = 0;
    for (auto step = path_.rbegin(); step != path_.rend(); ++step) {
      backup(*step);
      states += graph_[*step].belief.size();
    }
    if (vectors_added_ > std::max<std::size_t>(200, vectors() / 4)) prune();
    return states;
  }

  double over_roots(double Node::*bound) {
    double sum = 0;
    for (const Root& root : roots_) sum += root.weight * graph_[root.node].*bound;
    return sum;
  }

  double weighted_gap(const Root& root) {
    const Node& node = graph_[root.node];
    return root.weight * (node.upper - node.lower);
  }

  template <class IsOver>
  void sample(std::uint32_t number, double precision, IsOver&& is_over) {
    const bool follows_upper = sampled_++ % 2 == 1;
    path_.clear();
    const double gap = graph_[number].upper - graph_[number].lower;
    double allowed = std::max(precision, share_of_gap_ * gap);
    double low = graph_[number].lower;
    double high = low + allowed;
    while (path_.size() < longest_trial_) {
      Node& node = graph_[number];
      graph_.refresh_lower(node);
      graph_.refresh_upper(node);
      if (node.upper <= low && node.upper <= std::max(high, node.lower + allowed)) return;
      path_.push_back(number);
      graph_.expand(node);
      if (is_over()) return;
      if (node.branches.empty()) return;
      const Branch* const best = followed_branch(node, follows_upper);
      double best_lower = -std::numeric_limits<double>::infinity();
      for (const Branch& branch : node.branches) best_lower = std::max(best_lower, branch.lower);
      if (path_.size() == 1) ++trials_[best->action];
      low = std::max(low, best_lower);
      high = std::max(high, best_lower + allowed);
      allowed /= model_.discount;
      const Successor* next = widest_of(best->successors, allowed);
      if (next == nullptr) return;
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
  }

  // With the highest upper bound, or the highest middle of both bounds, among those of which it is known where they lead;
  // the one with the highest upper bound always is. Refreshes the bounds of these.
  const Branch* followed_branch(Node& node, bool follows_upper) {
    for (Branch& branch : node.branches) {
      if (branch.is_open) refresh(branch);
    }
    while (true) {
      Branch* highest = &node.branches.front();
      Branch* likeliest = nullptr;
      for (Branch& branch : node.branches) {
        if (branch.upper > highest->upper) highest = &branch;
        if (!branch.is_open) continue;
        if (likeliest == nullptr || branch.lower + branch.upper > likeliest->lower + likeliest->upper) likeliest = &branch;
      }
      if (highest->is_open) return follows_upper ? highest : likeliest;
      graph_.open(node, *highest);
      refresh(*highest);
    }
  }

  void refresh(Branch& branch) {
    branch.lower = refreshed_lower(branch);
    branch.upper = std::min(branch.upper, refreshed_upper(branch));
  }

  // The successor with the most gap beyond what is allowed there.
  const Successor* widest_of(const std::vector<Successor>& successors, double allowed) {
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

  double refreshed_lower(const Branch& branch) {
    return backed_up(branch, [this](Node& node) { return graph_.refresh_lower(node), node.lower; });
  }

  double refreshed_upper(const Branch& branch) {
    return backed_up(branch, [this](Node& node) { return graph_.refresh_upper(node), node.upper; });
  }

  // The branch's value, given that of each node behind it.
  template <class ValueOf>
  double backed_up(const Branch& branch, ValueOf value_of) {
    double sum = 0;
    for (const Successor& successor : branch.successors)
      sum += successor.probability * value_of(graph_[successor.node]);
    return branch.reward + model_.discount * sum;
  }

  void backup(std::uint32_t number) {
    ++backups_;
    Node& node = graph_[number];
    if (node.branches.empty()) return;
    graph_.refresh_lower(node);
    const Branch* best = nullptr;
    double best_lower = -std::numeric_limits<double>::infinity();
    double best_upper = best_lower;
    for (Branch& branch : node.branches) {
      if (!branch.is_open) {
        best_upper = std::max(best_upper, branch.upper);
        continue;
      }
      refresh(branch);
      best_upper = std::max(best_upper, branch.upper);
      if (best != nullptr && branch.lower <= best_lower) continue;
      best = &branch;
      best_lower = branch.lower;
    }
    const double worth_it = 1e-9 * (1 + std::abs(node.lower));
    if (best != nullptr && best_lower > node.lower + worth_it) add_vector(node, *best);
    if (best_upper < node.upper - worth_it) {
      node.upper = best_upper;
      UpperBound& bound = graph_.upper(node.region);
      if (node.point == nowhere) {
        node.point = bound.add(node.belief, node.corner, node.upper);
      } else {
        bound.improve(node.point, node.corner, node.upper);
      }
    }
    std::erase_if(node.branches, [&](const Branch& branch) { return branch.upper < node.lower - worth_it; });
  }

  void add_vector(Node& node, const Branch& branch) {
    const Move& move = regions_.all[node.region].moves[branch.action];
    chosen_.assign(move.sights.size(), nullptr);
    for (const Successor& successor : branch.successors) {
      const Node& child = graph_[successor.node];
      chosen_[successor.sight] = &graph_.lower(child.region)[child.vector];
    }
    later_.assign(move.targets, 0.0);
    for (std::uint32_t sight = 0; sight < move.sights.size(); ++sight) {
      if (chosen_[sight] == nullptr) chosen_[sight] = &uninformed_choice(node.region, branch.action, sight);
      const std::vector<double>& values = chosen_[sight]->values;
      for (const Sight::Landing& landing : move.sights[sight].landings) {
        later_[landing.target] += landing.probability * values[landing.local];
      }
    }
    AlphaVector vector{branch.action, false, move.rewards};
    for (std::size_t state = 0; state < vector.values.size(); ++state) {
      double sum = 0;
      for (const auto* flow = move.flows.begin(state); flow != move.flows.end(state); ++flow) {
        sum += flow->probability * later_[flow->target];
      }
      vector.values[state] += model_.discount * sum;
    }
    graph_.count_bytes(vector.values.size() * sizeof(double) + sizeof vector);
    graph_.lower(node.region).add(std::move(vector));
    ++vectors_added_;
    graph_.refresh_lower(node);
  }

  const AlphaVector& uninformed_choice(std::uint32_t region, std::uint32_t action, std::uint32_t sight) {
    Node& node = graph_[graph_.uninformed_successor(region, action, sight)];
    graph_.refresh_lower(node);
    return graph_.lower(node.region)[node.vector];
  }

  const FlatModel& model_;
  const Regions& regions_;
  BeliefGraph graph_;
  std::vector<Root> roots_;
  std::vector<std::uint32_t> trials_;  // by action: how many began with it at a root
  std::vector<std::uint32_t> path_;
  std::vector<const AlphaVector*> chosen_;
  std::vector<double> later_;
  std::uint64_t sampled_ = 0;  // trials
  std::uint64_t backups_ = 0;
  std::size_t vectors_added_ = 0;
};

}  // namespace aos::point_based
