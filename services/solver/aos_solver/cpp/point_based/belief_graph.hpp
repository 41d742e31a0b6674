// The beliefs that were met, what actions lead to from them, and both bounds of their values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "point_based/bounds.hpp"
#include "point_based/initial_bounds.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

inline constexpr double negligible = 1e-12;

struct Successor {
  double probability;
  std::uint32_t sight;
  std::uint32_t node;
};

// An action at a belief. Where it leads is found out only when its upper bound is the highest: most never are.
struct Branch {
  std::uint32_t action;
  double reward;
  double upper;
  double lower = -std::numeric_limits<double>::infinity();
  bool is_open = false;
  std::vector<Successor> successors{};
};

struct Node {
  Belief belief;
  std::uint32_t region;
  std::uint32_t vector = 0;          // the best alpha vector
  std::uint32_t seen_vectors = 0;    // how many the lower bound is of
  std::uint32_t seen_changes = 0;    // of the upper bound
  std::uint32_t point = nowhere;     // in the upper bound
  double corner = 0;                 // what the upper bound is interpolated to be from single states
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool is_expanded = false;
  std::vector<Branch> branches;  // actions that may still be the best
};

class BeliefGraph {
 public:
  BeliefGraph(const FlatModel& model, const Regions& regions)
      : model_(model), regions_(regions) {
    const InitialBounds bounds{model, regions};
    const ActionValues informed = bounds.informed_values();
    std::vector<std::vector<double>> blind;
    for (std::size_t action = 0; action < model.actions; ++action) blind.push_back(bounds.blind_values(action));
    std::size_t largest = 0;
    for (const Region& region : regions.all) {
      largest = std::max(largest, region.states.size());
      add_bounds(region, informed, blind);
    }
    posterior_.assign(largest, 0.0);
  }

  // The node of a belief over the region's states (by local number, ascending; normalised).
  std::uint32_t node_of(std::uint32_t region, const Belief& belief) {
    const Key key = key_of(region, belief);
    const auto [entry, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(nodes_.size()));
    if (!is_new) return entry->second;
    bytes_ += sizeof(Node) + belief.size() * (sizeof(double) + sizeof(std::uint32_t)) + 64;
    Node& node = nodes_.emplace_back();
    node.region = region;
    node.belief = belief;
    UpperBound& bound = upper_[region];
    const std::vector<double> informed = informed_values(node);
    node.corner = bound.corner_of(node.belief);
    node.upper = std::min(bound.of(node.belief, node.corner), *std::max_element(informed.begin(), informed.end()));
    node.seen_changes = bound.changes();
    refresh_lower(node);
    return entry->second;
  }

  Node& operator[](std::uint32_t number) { return nodes_[number]; }
  std::size_t size() const { return nodes_.size(); }
  std::size_t bytes() const { return bytes_; }
  LowerBound& lower(std::uint32_t region) { return lower_[region]; }
  const LowerBound& lower(std::uint32_t region) const { return lower_[region]; }
  UpperBound& upper(std::uint32_t region) { return upper_[region]; }
  void count_bytes(std::size_t bytes) { bytes_ += bytes; }

  // Lists the actions, those left out that cannot be the best.
  void expand(Node& node) {
    if (node.is_expanded) return;
    node.is_expanded = true;
    const std::vector<double> informed = informed_values(node);
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      if (informed[action] < node.lower) continue;
      node.branches.push_back({action, expected(move(node, action).rewards, node.belief), informed[action]});
      bytes_ += sizeof(Branch);
    }
  }

  // Finds where an action leads.
  void open(const Node& node, Branch& branch) {
    branch.is_open = true;
    add_successors(node.belief, move(node, branch.action), branch.successors);
    bytes_ += branch.successors.size() * sizeof(Successor);
  }

  // What an action leads to, whether or not it may be the best; `upper` bounds what it is worth.
  Branch branch(const Node& node, std::uint32_t action, double upper) {
    Branch branch{action, expected(move(node, action).rewards, node.belief), upper};
    add_successors(node.belief, move(node, action), branch.successors);
    return branch;
  }

  // Keeps the bounds of the beginning only.
  void start_over() {
    for (LowerBound& bound : lower_) bound.keep_blind();
    forget_beliefs();
  }

  // Keeps alpha vectors and the values of single states only.
  void forget_beliefs() {
    index_.clear();
    uninformed_.clear();
    nodes_.clear();
    bytes_ = 0;
    for (UpperBound& bound : upper_) bound.forget_points();
    for (LowerBound& bound : lower_) {
      bound.close_gaps();
      for (std::uint32_t number = 0; number < bound.size(); ++number) {
        bytes_ += bound[number].values.size() * sizeof(double) + sizeof(AlphaVector);
      }
    }
  }

  // What each action is worth at most, by what knowing more would give.
  std::vector<double> informed_values(const Node& node) const {
    const double* const values = informed_[node.region].data();
    std::vector<double> sums(model_.actions, 0.0);
    for (std::size_t i = 0; i < node.belief.size(); ++i) {
      const double* const row = values + model_.row(node.belief.states[i], 0);
      const double probability = node.belief.probabilities[i];
      for (std::size_t action = 0; action < sums.size(); ++action) sums[action] += probability * row[action];
    }
    return sums;
  }

  void refresh_lower(Node& node) {
    const LowerBound& bound = lower_[node.region];
    if (bound[node.vector].is_gone()) node.seen_vectors = 0;
    if (node.seen_vectors == bound.size()) return;
    double best = node.seen_vectors == 0 ? -std::numeric_limits<double>::infinity() : node.lower;
    for (; node.seen_vectors < bound.size(); ++node.seen_vectors) {
      const AlphaVector& vector = bound[node.seen_vectors];
      if (vector.is_gone()) continue;
      const double value = expected(vector.values, node.belief);
      if (value <= best) continue;
      best = value;
      node.vector = node.seen_vectors;
    }
    node.lower = std::max(node.lower, best);
  }

  void refresh_upper(Node& node) {
    UpperBound& bound = upper_[node.region];
    node.upper = bound.of(node.belief, node.corner, node.upper, node.seen_changes);
    node.seen_changes = bound.changes();
  }

  // Where an observation leads from a region about which nothing else is known.
  std::uint32_t uninformed_successor(std::uint32_t region, std::uint32_t action, std::uint32_t sight) {
    const std::uint64_t key = (std::uint64_t{region} * model_.actions + action) << 24 | sight;
    const auto known = uninformed_.find(key);
    if (known != uninformed_.end()) return known->second;
    const Region& from = regions_.all[region];
    Belief belief;
    for (std::uint32_t state = 0; state < from.states.size(); ++state) {
      belief.states.push_back(state);
      belief.probabilities.push_back(1.0 / static_cast<double>(from.states.size()));
    }
    std::vector<Successor> successors;
    add_successors(belief, from.moves[action], successors);
    for (const Successor& successor : successors) {
      uninformed_[(std::uint64_t{region} * model_.actions + action) << 24 | successor.sight] = successor.node;
    }
    return uninformed_.at(key);
  }

 private:
  struct Key {
    std::uint64_t high, low;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const { return key.high ^ key.low; }
  };

  const Move& move(const Node& node, std::uint32_t action) const { return regions_.all[node.region].moves[action]; }

  static std::uint64_t mixed(std::uint64_t left, std::uint64_t right) {
    std::uint64_t x = (left ^ right) * 0x9e3779b97f4a7c15u;
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93u;
    return x ^ (x >> 29);
  }

  // Probabilities are rounded to 1e-9, so that different ways to the same belief meet.
  static Key key_of(std::uint32_t region, const Belief& belief) {
    Key key{mixed(0x9ae16a3b2f90404fu, region), mixed(0xc949d7c7509e6557u, region)};
    for (std::size_t i = 0; i < belief.size(); ++i) {
      // Sums, so that a processor need not finish one state before it begins the next.
      const auto rounded = static_cast<std::uint64_t>(static_cast<std::int64_t>(belief.probabilities[i] * 1e9 + 0.5));
      key.high += mixed(rounded, belief.states[i]);
      key.low += mixed(rounded * 0x2545f4914f6cdd1du, ~std::uint64_t{belief.states[i]});
    }
    return key;
  }

  void add_bounds(const Region& region, const ActionValues& informed, const std::vector<std::vector<double>>& blind) {
    ActionValues own;
    std::vector<double> corners;
    for (const std::uint32_t state : region.states) {
      const double* first = informed.data() + model_.row(state, 0);
      own.insert(own.end(), first, first + model_.actions);
      corners.push_back(*std::max_element(first, first + model_.actions));
    }
    informed_.push_back(std::move(own));
    upper_.emplace_back(std::move(corners));
    std::vector<AlphaVector> vectors;
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      AlphaVector vector{action, true, {}};
      for (const std::uint32_t state : region.states) vector.values.push_back(blind[action][state]);
      const auto is_no_better = [&](const AlphaVector& known) { return is_nowhere_above(vector.values, known.values); };
      if (std::any_of(vectors.begin(), vectors.end(), is_no_better)) continue;
      std::erase_if(vectors, [&](const AlphaVector& known) { return is_nowhere_above(known.values, vector.values); });
      vectors.push_back(std::move(vector));
    }
    LowerBound lower;
    for (AlphaVector& vector : vectors) lower.add(std::move(vector));
    lower_.push_back(std::move(lower));
  }

  static bool is_nowhere_above(const std::vector<double>& values, const std::vector<double>& others) {
    return std::equal(values.begin(), values.end(), others.begin(), std::less_equal<>{});
  }

  void add_successors(const Belief& belief, const Move& move, std::vector<Successor>& successors) {
    predicted_.assign(move.targets, 0.0);
    for (std::size_t i = 0; i < belief.size(); ++i) {
      const auto* last = move.flows.end(belief.states[i]);
      for (const auto* flow = move.flows.begin(belief.states[i]); flow != last; ++flow) {
        predicted_[flow->target] += belief.probabilities[i] * flow->probability;
      }
    }
    for (std::uint32_t number = 0; number < move.sights.size(); ++number) {
      const Sight& sight = move.sights[number];
      next_.states.clear();
      next_.probabilities.clear();
      const double total = sight.is_ascending ? add_landings(sight) : gather_landings(sight);
      if (total <= negligible) continue;
      normalise(next_, total);
      successors.push_back({total, number, node_of(sight.region, next_)});
    }
  }

  // Sets `next_` where each landing is in a state of its own. Returns the sum of the probabilities.
  double add_landings(const Sight& sight) {
    double total = 0;
    for (const Sight::Landing& landing : sight.landings) {
      const double weight = predicted_[landing.target] * landing.probability;
      if (weight <= 0) continue;
      next_.states.push_back(landing.local);
      next_.probabilities.push_back(weight);
      total += weight;
    }
    return total;
  }

  double gather_landings(const Sight& sight) {
    double total = 0;
    for (const Sight::Landing& landing : sight.landings) {
      const double weight = predicted_[landing.target] * landing.probability;
      if (weight <= 0) continue;
      if (posterior_[landing.local] == 0) next_.states.push_back(landing.local);
      posterior_[landing.local] += weight;
      total += weight;
    }
    if (!std::is_sorted(next_.states.begin(), next_.states.end())) std::sort(next_.states.begin(), next_.states.end());
    for (const std::uint32_t local : next_.states) next_.probabilities.push_back(std::exchange(posterior_[local], 0.0));
    return total;
  }

  // States that are next to impossible are left out.
  static void normalise(Belief& belief, double total) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < belief.size(); ++i) {
      if (belief.probabilities[i] <= negligible * total) continue;
      belief.states[kept] = belief.states[i];
      belief.probabilities[kept++] = belief.probabilities[i] / total;
    }
    belief.states.resize(kept);
    belief.probabilities.resize(kept);
  }

  const FlatModel& model_;
  const Regions& regions_;
  std::vector<ActionValues> informed_;  // of a region, by its states
  std::vector<LowerBound> lower_;
  std::vector<UpperBound> upper_;
  std::deque<Node> nodes_;
  std::unordered_map<Key, std::uint32_t, KeyHash> index_;
  std::unordered_map<std::uint64_t, std::uint32_t> uninformed_;
  std::size_t bytes_ = 0;
  std::vector<double> predicted_;
  std::vector<double> posterior_;
  Belief next_;  // room for one belief
};

}  // namespace aos::point_based
