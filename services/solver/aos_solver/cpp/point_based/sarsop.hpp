// Point-based value iteration near the beliefs that a good policy reaches (SARSOP: Kurniawati, Hsu and Lee, 2008).
//
// A trial follows the action with the highest upper bound and the observation that matters most for the gap at the
// root, until nothing more can be learnt for the root; then both bounds are backed up along the way. Upper bounds that are
// far too high say little about what is worth improving, and the lower bound is what is carried out. So of three trials one
// follows the highest middle of both bounds, and one the highest lower bound, with a look at all actions. The first trials
// from a belief do the same action again and again before that: what lies behind a long detour is hardly found by
// bounds. Actions whose upper bound is below the belief's lower bound are dropped, and alpha vectors that are best at no remaining belief.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "point_based/belief_graph.hpp"
#include "point_based/online.hpp"

namespace aos::point_based {

// Bounds that are told.
inline std::pair<double, double> checked(double lower, double upper) {
  if (lower <= upper) return {lower, upper};
  throw CrossedBounds("the lower bound " + std::to_string(lower) + " is above the upper bound " + std::to_string(upper));
}

class Sarsop {
 public:
  Sarsop(const FlatModel& model, const Regions& regions) : model_(model), regions_(regions), graph_(model, regions) {
    trials_.assign(model.actions, 0);
    for (const Start& start : model.starts) add_start(start);
  }

  // What a policy is sure to give from the start, and what none can give more than; discounted.
  double lower() const { return over_roots(&Node::lower, -1); }
  double upper() const { return over_roots(&Node::upper, 1); }
  // No state is worth more, or 0.
  double most() const { return graph_.most(); }
  // Some policy gives no less, wherever it begins; or 0.
  double least() const { return graph_.least(); }
  // Bounds that are so near, beside the values themselves, are as near as numbers tell.
  double noise() const { return graph_.noise(); }
  // Numbers that were multiplied so far.
  std::uint64_t work() const { return graph_.work(); }
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
    forget_roots();
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
    forget_roots();
    add_start(start);
  }

  // One trial, with backups; it is cut short after `is_over()`. Returns whether there was anything to find out.
  template <class IsOver>
  bool improve(double precision, IsOver&& is_over) {
    const Root* widest = nullptr;
    for (const Root& root : roots_) {
      if (widest == nullptr || weighted_gap(root) > weighted_gap(*widest)) widest = &root;
    }
    return widest != nullptr && improve_from(widest->node, precision, is_over);
  }

  // The same below an action that is carried out at the only start.
  template <class IsOver>
  bool improve_below(std::uint32_t action, double precision, IsOver&& is_over) {
    if (roots_.empty()) return false;
    const Branch& branch = root_branch(action);
    refreshed_lower(branch);
    refreshed_upper(branch);
    const Successor* next = widest_of(branch.successors, precision);
    return next != nullptr && improve_from(next->node, precision, is_over);
  }

  // Of all actions at the only start.
  std::vector<ActionBounds> action_bounds() {
    std::vector<ActionBounds> bounds(model_.actions);
    if (roots_.empty()) return bounds;
    const double weight = roots_.front().weight;
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      Branch& branch = root_branch(action);
      refresh(branch);
      bounds[action] = {moved(weight * branch.lower, -1), moved(weight * branch.upper, 1), trials_[action]};
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
      for (std::uint32_t number = bound.initial(); number < bound.size(); ++number) {
        if (!is_best[region][number] && !bound[number].is_gone()) bound.give_up(number);
      }
    }
  }

 private:
  struct Root {
    double weight;
    std::uint32_t node;
  };
  // By which bound a trial goes.
  enum class Follows { middle, upper, lower };

  static constexpr double share_of_gap_ = 0.1;  // of the root's, that a trial tries to come below
  static constexpr std::size_t longest_trial_ = 1000;
  static constexpr std::size_t longest_detour_ = 30;

  void forget_roots() {
    roots_.clear();
    dropped_at_root_.clear();
    trials_.assign(model_.actions, 0);
    idle_ = 0;
    persisted_ = 0;
  }

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
    const auto left = static_cast<std::uint32_t>(model_.horizon);
    const double share = start.weight * total;
    roots_.push_back({share, graph_.node_of(region, left, belief)});
  }

  // Whether a trial has found anything out, or one of the other kind may.
  template <class IsOver>
  bool improve_from(std::uint32_t number, double precision, IsOver&& is_over) {
    has_learnt_ = false;
    path_.clear();
    const bool persists = persisted_ < model_.actions;
    if (persists) {
      persist(number, persisted_++, is_over);
    } else {
      sample(number, precision, is_over);
    }
    for (auto step = path_.rbegin(); step != path_.rend(); ++step) backup(*step);
    if (vectors_added_ > std::max<std::size_t>(200, vectors() / 4)) prune();
    idle_ = has_learnt_ || persists ? 0 : idle_ + 1;
    return idle_ < 3;
  }

  // Outwards, by more than rounding can have moved it inwards.
  double moved(double value, double direction) const { return value + direction * 8 * graph_.rounding() * std::abs(value); }

  double over_roots(double Node::*bound, double direction) const {
    double sum = 0;
    double size = 0;
    for (const Root& root : roots_) {
      const double value = root.weight * graph_[root.node].*bound;
      sum += value;
      size += std::abs(value);
    }
    return sum + direction * 8 * graph_.rounding() * size;
  }

  double weighted_gap(const Root& root) const {
    const Node& node = graph_[root.node];
    return root.weight * (node.upper - node.lower);
  }

  // Of the only start; of what was dropped there as well. Open.
  Branch& root_branch(std::uint32_t action) {
    Node& node = graph_[roots_.front().node];
    graph_.expand(node);
    for (Branch& branch : node.branches) {
      if (branch.action == action) return graph_.open(node, branch), branch;
    }
    for (Branch& branch : dropped_at_root_) {
      if (branch.action == action) return branch;
    }
    Branch& branch = dropped_at_root_.emplace_back(
        graph_.closed_branch(node, action, graph_.informed_values(node)[action]));
    graph_.open(node, branch);
    return branch;
  }

  // The same action for as long as it may be the best and leads on, with the likeliest observation each time.
  template <class IsOver>
  void persist(std::uint32_t number, std::uint32_t action, IsOver&& is_over) {
    while (path_.size() < longest_detour_) {
      Node& node = graph_[number];
      graph_.expand(node);
      const auto branch = std::find_if(node.branches.begin(), node.branches.end(),
                                       [&](const Branch& candidate) { return candidate.action == action; });
      if (branch == node.branches.end()) return;
      path_.push_back(number);
      if (!branch->is_open) has_learnt_ = true;
      graph_.open(node, *branch);
      refresh(*branch);
      const Successor* likeliest = nullptr;
      for (const Successor& successor : branch->successors) {
        if (likeliest == nullptr || successor.probability > likeliest->probability) likeliest = &successor;
      }
      if (likeliest == nullptr || likeliest->node == number || is_over()) return;
      number = likeliest->node;
    }
  }

  template <class IsOver>
  void sample(std::uint32_t number, double precision, IsOver&& is_over) {
    const auto follows = static_cast<Follows>(sampled_++ % 3);
    const double gap = graph_[number].upper - graph_[number].lower;
    double allowed = std::max(precision, share_of_gap_ * gap);
    double low = graph_[number].lower;
    double high = low + allowed;
    const std::size_t longest = path_.size() + longest_trial_;
    while (path_.size() < longest) {
      Node& node = graph_[number];
      graph_.refresh_lower(node);
      graph_.refresh_upper(node);
      if (node.upper <= low && node.upper <= std::max(high, node.lower + allowed)) return;
      path_.push_back(number);
      graph_.expand(node);
      if (is_over()) return;
      const Branch* const best = followed_branch(node, follows, is_over);
      if (best == nullptr) return;
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

  // Among the actions of which it is known where they lead; of the one with the highest upper bound it always is. None if
  // `is_over()` before. Refreshes the bounds of these.
  template <class IsOver>
  const Branch* followed_branch(Node& node, Follows follows, IsOver&& is_over) {
    for (Branch& branch : node.branches) {
      if (follows == Follows::lower && !branch.is_open && !is_over()) {
        graph_.open(node, branch);
        has_learnt_ = true;
      }
      if (branch.is_open) refresh(branch);
    }
    while (!node.branches.empty()) {
      Branch* highest = &node.branches.front();
      Branch* followed = nullptr;
      for (Branch& branch : node.branches) {
        if (branch.upper > highest->upper) highest = &branch;
        if (branch.is_open && (followed == nullptr || merit(branch, follows) > merit(*followed, follows))) followed = &branch;
      }
      if (highest->is_open) return followed;
      graph_.open(node, *highest);
      refresh(*highest);
      has_learnt_ = true;
      if (is_over()) break;
    }
    return nullptr;
  }

  static double merit(const Branch& branch, Follows follows) {
    return (follows == Follows::upper ? 0 : branch.lower) + (follows == Follows::lower ? 0 : branch.upper);
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
    const double rest = -branch.rest * graph_.largest_value();
    return backed_up(branch, rest, -1, [this](Node& node) { return graph_.refresh_lower(node), node.lower; });
  }

  double refreshed_upper(const Branch& branch) {
    return backed_up(branch, branch.rest_upper, 1, [this](Node& node) { return graph_.refresh_upper(node), node.upper; });
  }

  // The branch's value, given that of each node behind it and of the rest; moved outwards.
  template <class ValueOf>
  double backed_up(const Branch& branch, double rest, double direction, ValueOf value_of) {
    double sum = rest;
    double size = std::abs(branch.reward) + std::abs(rest);
    for (const Successor& successor : branch.successors) {
      const double part = successor.probability * value_of(graph_[successor.node]);
      sum += part;
      size += std::abs(part);
    }
    return branch.reward + model_.discount * sum + direction * graph_.rounding() * size;
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
      if (branch.is_open) refresh(branch);
      best_upper = std::max(best_upper, branch.upper);
      if (!branch.is_open || (best != nullptr && branch.lower <= best_lower)) continue;
      best = &branch;
      best_lower = branch.lower;
    }
    const double worth_it = graph_.noise_of_one();
    if (best != nullptr && best_lower > node.lower + worth_it) {
      const double before = node.lower;
      add_vector(node, *best);
      if (node.lower > before + worth_it) has_learnt_ = true;
    }
    if (best_upper < node.upper - worth_it) {
      has_learnt_ = true;
      node.upper = best_upper;
      UpperBound& bound = graph_.upper_of(node.region, node.left);
      if (node.point == nowhere) {
        node.point = bound.add(node.belief, node.corner, node.upper);
      } else {
        bound.improve(node.point, node.corner, node.upper);
      }
    }
    std::erase_if(node.branches, [&](const Branch& branch) { return branch.upper < node.lower; });
  }

  // The plan that begins with the branch's action and goes on with the best plan of each node behind it. A plan for
  // what cannot be observed from here is chosen as if nothing were known, since the vector is for the whole region.
  void add_vector(Node& node, const Branch& branch) {
    const Move& move = regions_.all[node.region].moves[branch.action];
    std::vector<double> values = move.rewards;
    std::uint32_t length = node.left;
    double size = 0;
    if (!graph_.is_last(node)) {
      const std::uint32_t left = graph_.is_free_to_go_on() ? longest_plan(branch) : graph_.left_after(node);
      length = graph_.is_endless() ? 0 : left + 1;
      choose_plans(node, branch, left);
      later_.assign(move.targets, 0.0);
      for (std::uint32_t sight = 0; sight < move.sights.size(); ++sight) {
        if (chosen_[sight] == nullptr) continue;
        const AlphaVector& plan = *chosen_[sight];
        const double tail = plan.length == left ? 0 : graph_.tail(plan.length, left);
        size = std::max(size, plan.size - tail);
        for (const Sight::Landing& landing : move.sights[sight].landings) {
          later_[landing.target] += landing.probability * (plan.values[landing.local] + tail);
        }
        graph_.count_work(move.sights[sight].landings.size());
      }
      graph_.count_work(move.flows.elements.size());
      for (std::size_t state = 0; state < values.size(); ++state) {
        double sum = 0;
        for (const auto* flow = move.flows.begin(state); flow != move.flows.end(state); ++flow) {
          sum += flow->probability * later_[flow->target];
        }
        values[state] += model_.discount * sum - 2 * graph_.rounding() * (size + std::abs(move.rewards[state]));
      }
    }
    graph_.add_vector(node.region, {branch.action, length, std::move(values)});
    ++vectors_added_;
    graph_.refresh_lower(node);
  }

  // Of the best plans behind a branch.
  std::uint32_t longest_plan(const Branch& branch) {
    std::uint32_t longest = graph_.is_endless() ? 0 : 1;
    for (const Successor& successor : branch.successors) {
      const Node& child = graph_[successor.node];
      longest = std::max(longest, graph_.lower(child.region)[child.vector].length);
    }
    return longest;
  }

  // By sight; none where nothing may follow.
  void choose_plans(const Node& node, const Branch& branch, std::uint32_t left) {
    const Move& move = regions_.all[node.region].moves[branch.action];
    chosen_.assign(move.sights.size(), nullptr);
    for (const Successor& successor : branch.successors) {
      const Node& child = graph_[successor.node];
      chosen_[successor.sight] = &graph_.lower(child.region)[child.vector];
    }
    for (std::uint32_t sight = 0; sight < move.sights.size(); ++sight) {
      if (chosen_[sight] != nullptr) continue;
      const std::uint32_t number = graph_.uninformed_successor(node.region, left, branch.action, sight);
      if (number == nowhere) {
        const std::uint32_t region = move.sights[sight].region;
        graph_.lower(region).for_blind(left, [&](std::uint32_t blind) { chosen_[sight] = &graph_.lower(region)[blind]; });
        continue;
      }
      Node& child = graph_[number];
      graph_.refresh_lower(child);
      chosen_[sight] = &graph_.lower(child.region)[child.vector];
    }
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
  bool has_learnt_ = false;  // in this trial
  std::uint32_t persisted_ = 0;  // actions, from the roots of now
  int idle_ = 0;             // trials one after another that have learnt nothing
  std::deque<Branch> dropped_at_root_;
};

}  // namespace aos::point_based
