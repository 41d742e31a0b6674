// Backups: both bounds of a belief, from the bounds of its successors.
#pragma once

#include "point_based/belief_graph.hpp"

namespace aos::point_based {

class Backups {
 public:
  Backups(const FlatModel& model, const Regions& regions, BeliefGraph& graph)
      : model_(model), regions_(regions), graph_(graph) {}

  std::uint64_t count() const { return backups_; }
  // How many alpha vectors were added since this was set to 0.
  std::size_t vectors_added = 0;

  void refresh(Branch& branch) {
    branch.lower = refreshed_lower(branch);
    branch.upper = std::min(branch.upper, refreshed_upper(branch));
  }

  double refreshed_lower(const Branch& branch) {
    const double rest = -branch.rest * graph_.largest_value();
    return backed_up(branch, rest, -1, [this](Node& node) { return graph_.refresh_lower(node), node.lower; });
  }

  double refreshed_upper(const Branch& branch) {
    return backed_up(branch, branch.rest_upper, 1, [this](Node& node) { return graph_.refresh_upper(node), node.upper; });
  }

  // Backs up both bounds of a node by its open actions. Returns whether one has moved by more than rounding.
  bool backup(std::uint32_t number) {
    ++backups_;
    bool has_moved = false;
    Node& node = graph_[number];
    if (node.branches.empty()) return false;
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
      if (node.lower > before + worth_it) has_moved = true;
    }
    if (best_upper < node.upper - worth_it) {
      has_moved = true;
      node.upper = best_upper;
      UpperBound& bound = graph_.upper_of(node.region, node.left);
      if (node.point == nowhere) node.point = bound.add(node.belief, node.corner, node.upper);
      else bound.improve(node.point, node.corner, node.upper);
    }
    erase_if(node.branches, [&](const Branch& branch) { return branch.upper < node.lower; });
    return has_moved;
  }

 private:
  // The branch's value from the values of its successors and of the rest, moved outwards by the rounding.
  [[gnu::optimize("O3")]] double backed_up(const Branch& branch, double rest, double direction, auto value_of) {
    double sum = rest;
    double size = std::abs(branch.reward) + std::abs(rest);
    for (const Successor& successor : branch.successors) {
      const double part = successor.probability * value_of(graph_[successor.node]);
      sum += part;
      size += std::abs(part);
    }
    return branch.reward + model_.discount * sum + direction * graph_.rounding() * size;
  }

  // Adds the vector of the plan that begins with the branch's action and continues with the best plan of each
  // successor. The vector serves the whole region, so it needs plans for observations that are impossible
  // here. These plans are chosen as if nothing were known.
  void add_vector(Node& node, const Branch& branch) {
    const Move& move = regions_.all[node.region].moves[branch.action];
    List<double> values = move.rewards;
    std::uint32_t length = node.left;
    double size = 0;
    if (!graph_.is_last(node)) {
      const std::uint32_t left = graph_.is_free_to_go_on() ? longest_plan(branch) : graph_.left_after(node);
      length = graph_.is_endless() ? 0 : left + 1;
      choose_plans(node, branch, left);
      later_.assign(move.targets, 0.0);
      for (std::uint32_t observation_branch = 0; observation_branch < move.observation_branches.size(); ++observation_branch) {
        if (chosen_[observation_branch] == nullptr) continue;
        const AlphaVector& plan = *chosen_[observation_branch];
        const double tail = plan.length == left ? 0 : graph_.tail(plan.length, left);
        size = std::max(size, plan.size - tail);
        for (const ObservationBranch::Successor& successor : move.observation_branches[observation_branch].successors) {
          later_[successor.target] += successor.probability * (plan.values[successor.local] + tail);
        }
        graph_.count_work(move.observation_branches[observation_branch].successors.size());
      }
      graph_.count_work(2 * move.flows.elements.size());
      for (std::size_t state = 0; state < values.size(); ++state) {
        double sum = 0;
        for (const auto& flow : move.flows[state]) sum += flow.probability * later_[flow.target];
        values[state] += model_.discount * sum - 2 * graph_.rounding() * (size + std::abs(move.rewards[state]));
      }
    }
    constexpr std::uint64_t per_vector = 1400;
    graph_.count_work(per_vector + move.targets / 8 + 2 * move.rewards.size() + 10 * move.observation_branches.size());
    graph_.add_vector(node.region, {branch.action, length, std::move(values)});
    ++vectors_added;
    graph_.refresh_lower(node);
  }

  // The length of the longest of the successors' best plans.
  std::uint32_t longest_plan(const Branch& branch) {
    std::uint32_t longest = graph_.is_endless() ? 0 : 1;
    for (const Successor& successor : branch.successors) {
      const Node& child = graph_[successor.node];
      longest = std::max(longest, graph_.lower(child.region)[child.vector].length);
    }
    return longest;
  }

  // Sets `chosen_` for each observation branch; null where nothing may follow.
  void choose_plans(const Node& node, const Branch& branch, std::uint32_t left) {
    const Move& move = regions_.all[node.region].moves[branch.action];
    chosen_.assign(move.observation_branches.size(), nullptr);
    for (const Successor& successor : branch.successors) {
      const Node& child = graph_[successor.node];
      chosen_[successor.observation_branch] = &graph_.lower(child.region)[child.vector];
    }
    for (std::uint32_t observation_branch = 0; observation_branch < move.observation_branches.size(); ++observation_branch) {
      if (chosen_[observation_branch] != nullptr) continue;
      const std::uint32_t number = graph_.uninformed_successor(node.region, left, branch.action, observation_branch);
      if (number == nowhere) {
        const std::uint32_t region = move.observation_branches[observation_branch].region;
        graph_.lower(region).for_blind(left, [&](std::uint32_t blind) { chosen_[observation_branch] = &graph_.lower(region)[blind]; });
        continue;
      }
      Node& child = graph_[number];
      graph_.refresh_lower(child);
      chosen_[observation_branch] = &graph_.lower(child.region)[child.vector];
    }
  }

  const FlatModel& model_;
  const Regions& regions_;
  BeliefGraph& graph_;
  std::uint64_t backups_ = 0;
  List<const AlphaVector*> chosen_;
  List<double> later_;
};

}
