// What a belief is worth, from below and from above, by another way than the solver's: all beliefs that can be reached
// are listed, up to a limit, in long doubles; those at the limit are worth between the best of always doing the same
// and what somebody who sees the state would get.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "point_based/flat_model.hpp"

namespace exam::listed {

using aos::point_based::FlatModel;
using Real = long double;
using Values = aos::List<Real>;
using Belief = aos::List<std::pair<std::uint32_t, Real>>;  // by state, ascending

struct Interval {
  Real lower = -std::numeric_limits<Real>::infinity();
  Real upper = std::numeric_limits<Real>::infinity();
};

class ListedBeliefs {
 public:
  explicit ListedBeliefs(const FlatModel& model) : model_(model) {
    if (model.horizon == 0) {
      seen_.push_back(best_policy_values());
      for (std::size_t action = 0; action < model.actions; ++action) {
        always_.push_back({policy_values(aos::List<std::size_t>(model.states, action))});
      }
    } else {
      add_layers();
    }
    for (const double reward : model.rewards) largest_ = std::max<Real>(largest_, std::abs(reward));
  }

  // Of every action at a belief, with so many beliefs listed.
  aos::List<Interval> action_values(const Belief& belief, std::size_t max_nodes) {
    nodes_.clear();
    known_.clear();
    node_of(belief, model_.horizon);
    for (std::size_t i = 0; i < nodes_.size() && nodes_.size() < max_nodes; ++i) {
      if (model_.horizon == 0 || nodes_[i].left > 0) expand(i);
    }
    const std::size_t sweeps = model_.horizon == 0 ? 400 : 1;
    for (std::size_t sweep = 0; sweep < sweeps; ++sweep) {
      Real change = 0;
      for (std::size_t i = nodes_.size(); i-- > 0;) change = std::max(change, back_up(nodes_[i]));
      if (change == 0) break;
    }
    aos::List<Interval> values(model_.actions);
    for (std::size_t action = 0; action < model_.actions; ++action) {
      values[action] = nodes_[0].branches.empty() ? Interval{} : value_of(nodes_[0].branches[action]);
    }
    return values;
  }

  // By so much rounding may harm the figures here, and the claims that are compared to them.
  Real tolerance() const {
    const Real time = model_.horizon == 0 ? 1 / (1 - Real{model_.discount}) : static_cast<Real>(model_.horizon);
    return 1e-17L * largest_ * time * time + 1e-300L;
  }

  // After an action and an observation, not normalised.
  std::map<std::uint32_t, std::map<std::uint32_t, Real>> successors(const Belief& belief, std::size_t action) const {
    std::map<std::uint32_t, std::map<std::uint32_t, Real>> by_observation;
    for (const auto& [state, probability] : belief) {
      for (const auto& outcome : model_.outcomes[model_.row(state, action)]) {
        for (const auto& likelihood : model_.likelihoods[outcome.sensing]) {
          const Real weight = probability * outcome.probability * likelihood.probability;
          if (weight > 0) by_observation[likelihood.observation][outcome.next] += weight;
        }
      }
    }
    return by_observation;
  }

 private:
  struct Branch {
    Real reward = 0;
    aos::List<std::pair<Real, std::size_t>> successors;
  };
  struct Node {
    Belief belief;
    std::size_t left;
    Interval value;
    aos::List<Branch> branches;
  };

  static Real expected(const Values& values, const Belief& belief) {
    Real sum = 0;
    for (const auto& [state, probability] : belief) sum += probability * values[state];
    return sum;
  }

  Real row_value(std::size_t row, const Values& later) const {
    Real sum = 0;
    for (const auto& outcome : model_.outcomes[row]) sum += Real{outcome.probability} * later[outcome.next];
    return Real{model_.rewards[row]} + Real{model_.discount} * sum;
  }

  void add_layers() {
    seen_.assign(1, Values(model_.states, 0));
    always_.assign(model_.actions, seen_);
    for (std::size_t left = 1; left <= model_.horizon; ++left) {
      Values best(model_.states, -std::numeric_limits<Real>::infinity());
      for (std::size_t action = 0; action < model_.actions; ++action) {
        Values same(model_.states);
        for (std::size_t state = 0; state < model_.states; ++state) {
          const std::size_t row = model_.row(state, action);
          same[state] = row_value(row, always_[action].back());
          best[state] = std::max(best[state], row_value(row, seen_.back()));
        }
        always_[action].push_back(std::move(same));
      }
      seen_.push_back(std::move(best));
    }
  }

  // By elimination: exact but for rounding.
  Values policy_values(const aos::List<std::size_t>& policy) const {
    const std::size_t count = model_.states;
    aos::List<Values> matrix(count, Values(count + 1, 0));
    for (std::size_t state = 0; state < count; ++state) {
      matrix[state][state] = 1;
      const std::size_t row = model_.row(state, policy[state]);
      matrix[state][count] = model_.rewards[row];
      for (const auto& outcome : model_.outcomes[row]) matrix[state][outcome.next] -= Real{model_.discount} * outcome.probability;
    }
    for (std::size_t column = 0; column < count; ++column) {
      std::size_t pivot = column;
      for (std::size_t row = column + 1; row < count; ++row) {
        if (std::abs(matrix[row][column]) > std::abs(matrix[pivot][column])) pivot = row;
      }
      std::swap(matrix[column], matrix[pivot]);
      for (std::size_t row = 0; row < count; ++row) {
        if (row == column || matrix[row][column] == 0) continue;
        const Real share = matrix[row][column] / matrix[column][column];
        for (std::size_t i = column; i <= count; ++i) matrix[row][i] -= share * matrix[column][i];
      }
    }
    Values values(count);
    for (std::size_t state = 0; state < count; ++state) values[state] = matrix[state][count] / matrix[state][state];
    return values;
  }

  // Policies improved until nothing improves but by rounding (Howard): among policies worth the same it would go on for ever.
  Values best_policy_values() const {
    aos::List<std::size_t> policy(model_.states, 0);
    Values best;
    Real most = -std::numeric_limits<Real>::infinity();
    for (bool has_improved = true; has_improved;) {
      Values values = policy_values(policy);
      Real sum = 0, size = 0;
      for (const Real value : values) {
        sum += value;
        size += std::abs(value);
      }
      if (sum <= most + 1e-15L * size) break;
      most = sum;
      has_improved = false;
      for (std::size_t state = 0; state < model_.states; ++state) {
        for (std::size_t action = 0; action < model_.actions; ++action) {
          const Real now = row_value(model_.row(state, policy[state]), values);
          const Real other = row_value(model_.row(state, action), values);
          if (other <= now + 1e-15L * (std::abs(now) + std::abs(other))) continue;
          policy[state] = action;
          has_improved = true;
        }
      }
      best = std::move(values);
    }
    return best;
  }

  std::size_t node_of(const Belief& belief, std::size_t left) {
    aos::List<std::pair<std::uint32_t, std::uint64_t>> key{{0, left}};
    // Nearer than the tolerance allows for; equal beliefs by different ways are one.
    for (const auto& [state, probability] : belief) {
      key.emplace_back(state, static_cast<std::uint64_t>(std::llround(probability * 0x1p60L) >> 4));
    }
    const auto [entry, is_new] = known_.try_emplace(std::move(key), nodes_.size());
    if (is_new) {
      const std::size_t layer = model_.horizon == 0 ? 0 : left;
      Interval value{-std::numeric_limits<Real>::infinity(), expected(seen_[layer], belief)};
      for (const aos::List<Values>& same : always_) value.lower = std::max(value.lower, expected(same[layer], belief));
      nodes_.push_back({belief, left, value, {}});
    }
    return entry->second;
  }

  void expand(std::size_t number) {
    aos::List<Branch> branches(model_.actions);
    for (std::size_t action = 0; action < model_.actions; ++action) {
      for (const auto& [state, probability] : nodes_[number].belief) {
        branches[action].reward += probability * model_.rewards[model_.row(state, action)];
      }
      const std::size_t left = model_.horizon == 0 ? 0 : nodes_[number].left - 1;
      for (const auto& [observation, weights] : successors(nodes_[number].belief, action)) {
        Real total = 0;
        for (const auto& [state, weight] : weights) total += weight;
        Belief next;
        for (const auto& [state, weight] : weights) next.emplace_back(state, weight / total);
        branches[action].successors.emplace_back(total, node_of(next, left));
      }
    }
    nodes_[number].branches = std::move(branches);
  }

  Interval value_of(const Branch& branch) const {
    Interval value{branch.reward, branch.reward};
    for (const auto& [probability, next] : branch.successors) {
      value.lower += model_.discount * probability * nodes_[next].value.lower;
      value.upper += model_.discount * probability * nodes_[next].value.upper;
    }
    return value;
  }

  Real back_up(Node& node) {
    if (node.branches.empty()) return 0;
    Interval best{-std::numeric_limits<Real>::infinity(), -std::numeric_limits<Real>::infinity()};
    for (const Branch& branch : node.branches) {
      const Interval value = value_of(branch);
      best.lower = std::max(best.lower, value.lower);
      best.upper = std::max(best.upper, value.upper);
    }
    const Interval before = node.value;
    node.value = {std::max(before.lower, best.lower), std::min(before.upper, best.upper)};
    return std::max(node.value.lower - before.lower, before.upper - node.value.upper);
  }

  const FlatModel& model_;
  Real largest_ = 0;
  aos::List<Values> seen_;                   // by decisions left
  aos::List<aos::List<Values>> always_;    // by action, decisions left
  aos::List<Node> nodes_;
  std::map<aos::List<std::pair<std::uint32_t, std::uint64_t>>, std::size_t> known_;
};

}
