// The beliefs that were reached, the successors of their actions, and both bounds of their values.
//
// With a horizon, a belief has one node for each number of decisions that are left. A plan becomes longer by repeating
// any action at its end. So an alpha vector serves all beliefs with as many decisions left, or more.
#pragma once

#include <bit>
#include <unordered_map>

#include "aos/base/statistics.hpp"
#include "aos/base/switches.hpp"
#include "numbers/belief_key.hpp"
#include "point_based/belief_nodes.hpp"
#include "point_based/blind_plans.hpp"
#include "point_based/bounds.hpp"
#include "point_based/certainty_equivalent.hpp"
#include "point_based/initial_bounds.hpp"
#include "point_based/posterior.hpp"
#include "point_based/regions.hpp"
#include "point_based/rounding.hpp"

namespace aos::point_based {

class BeliefGraph {
 public:
  BeliefGraph(const FlatModel& model, const Regions& regions)
      : model_(model), regions_(regions), rounding_(rounding_of(longest_sum())) {
    InitialBounds bounds{model, regions, rounding_};
    informed_ = std::move(bounds.informed);
    for (const ActionValues& values : informed_) sizes_.push_back(largest_size(values));
    tails_ = Tails{model, bounds.blind};
    List<RegionPlan> plans;
    // In a single region such a plan would look at nothing, and missions that it decides ask less (docs/lab/bounds.md).
    if (switches::region_plans && regions.all.size() > 1) plans = RegionPlans{model, regions, bounds.blind, rounding_}.by_layer();
    for (std::uint32_t region = 0; region < regions.all.size(); ++region) {
      lower_.push_back(blind_bound(model, region, regions.all[region], bounds.blind, plans, tails_));
      for (std::uint32_t number = 0; number < lower_.back().size(); ++number) note_size(lower_.back()[number]);
    }
    if (switches::certainty_equivalent && is_endless()) add_certainty_equivalent(bounds.blind.front());
    posterior_.reserve(regions.largest());
    dense_.assign(regions.largest(), 0.0);
    upper_.resize(regions.all.size() * informed_.size());
    // Merging beliefs and leaving states out moves no bound by more than a harmless amount.
    const double decisions = lasting_decisions(model);
    const double harmless = 1e-7 / (decisions * decisions);
    negligible_ = std::min(1e-12, harmless);
    kept_bits_ = std::clamp(static_cast<int>(std::ceil(-std::log2(harmless))), 30, 47);
  }

  // The node of a belief over the region's states (by local number, ascending; normalised).
  std::uint32_t node_of(std::uint32_t region, std::uint32_t left, const Belief& belief) {
    const BeliefKey key = key_of(region, left, belief);
    work_ += per_look_up + 2 * belief.size();
    const auto [entry, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(nodes_.size()));
    if (!is_new) return entry->second;
    bytes_ += sizeof(Node) + belief.size() * (sizeof(double) + sizeof(std::uint32_t)) + 64;
    Node& node = nodes_.emplace_back();
    node.region = region;
    node.left = left;
    node.belief = belief;
    UpperBound& bound = upper_of(region, left);
    const List<double> informed = informed_values(node);
    node.corner = bound.corner_of(node.belief);
    node.upper = std::min(bound.of(node.belief, node.corner), *std::max_element(informed.begin(), informed.end()));
    node.seen_changes = bound.changes();
    work_ += per_node + belief.size() * (model_.actions + 1 + bound.points());
    refresh_lower(node);
    return entry->second;
  }

  Node& operator[](std::uint32_t number) { return nodes_[number]; }
  const Node& operator[](std::uint32_t number) const { return nodes_[number]; }
  std::size_t size() const { return nodes_.size(); }
  std::size_t bytes() const { return bytes_; }
  // The number of operations so far: multiplications with their look-ups, and what else takes as long as these.
  std::uint64_t work() const { return work_; }
  void count_work(std::uint64_t work) { work_ += work; }
  // The error of the longest sum, relative to the absolute values in it.
  double rounding() const { return rounding_; }
  // How much of a value may be rounding: of a value computed once, and of one that came about over all decisions.
  double noise_of_one() const { return 4 * rounding_ * sizes_.back(); }
  double noise() const { return 2 * rounding_ * sizes_.back() * lasting_decisions(model_); }
  LowerBound& lower(std::uint32_t region) { return lower_[region]; }
  const LowerBound& lower(std::uint32_t region) const { return lower_[region]; }
  UpperBound& upper_of(std::uint32_t region, std::uint32_t left) {
    std::unique_ptr<UpperBound>& bound = upper_[left * regions_.all.size() + region];
    if (!bound) {
      List<double> corners;
      for (const std::uint32_t state : regions_.all[region].states) corners.push_back(std::ranges::max(model_.of_actions(informed_[left], state)));
      bound = std::make_unique<UpperBound>(std::move(corners), rounding_, dense_);
    }
    return *bound;
  }
  void add_vector(std::uint32_t region, AlphaVector vector) {
    bytes_ += vector.values.size() * sizeof(double) + sizeof vector;
    note_size(vector);
    lower_[region].add(std::move(vector));
  }
  // No state is worth more. At least 0.
  double max_value() const { return std::max(0.0, *std::max_element(informed_.back().begin(), informed_.back().end())); }
  // Some policy gives at least this from every state on. At most 0.
  double min_value() const { return tails_.min_value(); }
  // The largest absolute value in any alpha vector.
  double largest_value() const { return largest_value_; }

  bool is_endless() const { return model_.horizon == 0; }
  // Whether nothing follows the next decision, and how many decisions are left after it (0 without a horizon).
  bool is_last(const Node& node) const { return node.left == 1; }
  std::uint32_t left_after(const Node& node) const { return node.left == 0 ? 0 : node.left - 1; }

  // Whether longer plans are worth no less than shorter ones, since some action costs nothing in any state.
  bool is_free_to_go_on() const { return tails_.are_free(); }
  double tail(std::uint32_t length, std::uint32_t left) const { return tails_.of(length, left); }

  // Adds a branch for each action that may be the best.
  void expand(Node& node) {
    if (node.is_expanded) return;
    node.is_expanded = true;
    work_ += model_.actions * (node.belief.size() + per_branch);
    const List<double> informed = informed_values(node);
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      if (informed[action] < node.lower) continue;
      node.branches.push_back(closed_branch(node, action, informed[action]));
      bytes_ += sizeof(Branch);
    }
  }

  // Finds the successors of a branch.
  void open(const Node& node, Branch& branch) {
    if (branch.is_open) return;
    branch.is_open = true;
    if (!is_last(node)) add_successors(node.belief, left_after(node), move(node, branch.action), branch);
    bytes_ += branch.successors.size() * sizeof(Successor);
  }

  // A branch without successors, for any action; `upper` bounds its value.
  Branch closed_branch(const Node& node, std::uint32_t action, double upper) const {
    return {action, expected(move(node, action).rewards, node.belief), upper};
  }
  Branch closed_branch(const Node& node, std::uint32_t action) const {
    double upper = rounding_ * sizes_[node.left];
    for (std::size_t i = 0; i < node.belief.size(); ++i) {
      const std::uint32_t state = regions_.all[node.region].states[node.belief.states[i]];
      upper += node.belief.probabilities[i] * model_.of_actions(informed_[node.left], state)[action];
    }
    return closed_branch(node, action, upper);
  }

  // Keeps the initial bounds only.
  void start_over() {
    for (LowerBound& bound : lower_) bound.keep_initial();
    forget_beliefs();
  }

  // Keeps the alpha vectors and the values of single states only.
  void forget_beliefs() {
    index_.clear();
    uninformed_.clear();
    nodes_.clear();
    bytes_ = 0;
    for (const auto& bound : upper_) {
      if (bound) bound->forget_points();
    }
    for (LowerBound& bound : lower_) {
      bound.close_gaps();
      for (std::uint32_t number = bound.initial(); number < bound.size(); ++number) {
        bytes_ += bound[number].values.size() * sizeof(double) + sizeof(AlphaVector);
      }
    }
  }

  // An upper bound of each action's value: the value if the robot knew more.
  List<double> informed_values(const Node& node) const { return informed_values(node.region, node.left, node.belief); }
  [[gnu::optimize("O3")]] List<double> informed_values(std::uint32_t region, std::uint32_t left, const Belief& belief) const {
    const List<std::uint32_t>& states = regions_.all[region].states;
    List<double> sums(model_.actions, rounding_ * sizes_[left]);
    const auto values_of = [&](std::size_t i) { return model_.of_actions(informed_[left], states[belief.states[i]]).data(); };
    // Several states at once, since to read and to write the sums takes as long as to multiply.
    constexpr std::size_t width = 4;
    const std::size_t whole = belief.size() / width * width;
    for (std::size_t i = 0; i < whole; i += width) {
      const double* const values[] = {values_of(i), values_of(i + 1), values_of(i + 2), values_of(i + 3)};
      const double* const p = &belief.probabilities[i];
      double* const out = sums.data();
      const double p0 = p[0], p1 = p[1], p2 = p[2], p3 = p[3];
      for (std::size_t action = 0; action < sums.size(); ++action) {
        out[action] += (p0 * values[0][action] + p1 * values[1][action]) + (p2 * values[2][action] + p3 * values[3][action]);
      }
    }
    for (std::size_t i = whole; i < belief.size(); ++i) {
      for (std::size_t action = 0; action < sums.size(); ++action) sums[action] += belief.probabilities[i] * values_of(i)[action];
    }
    return sums;
  }

  // A lower bound of an action's value that needs no look at what it leads to.
  double least(const Node& node, const Branch& branch) const {
    return branch.reward + (is_endless() ? model_.discount * min_value() : tail(1, node.left)) - noise_of_one();
  }

  // The lower bound of a belief that has no node, without a horizon.
  double lower_at(std::uint32_t region, const Belief& belief) {
    const LowerBound& bound = lower_[region];
    double best = -std::numeric_limits<double>::infinity();
    for (std::uint32_t number = 0; number < bound.size(); ++number) {
      if (!bound[number].is_gone()) best = std::max(best, expected(bound[number].values, belief));
    }
    work_ += bound.size() * (per_vector + belief.size());
    return best;
  }

  [[gnu::optimize("O3")]] void refresh_lower(Node& node) {
    work_ += per_look;
    const LowerBound& bound = lower_[node.region];
    if (bound[node.vector].is_gone()) node.seen_vectors = 0;
    if (node.seen_vectors == bound.size()) return;
    double best = node.seen_vectors == 0 ? -std::numeric_limits<double>::infinity() : node.lower;
    const auto take = [&](std::uint32_t number) {
      const double value = value_of(bound[number], node);
      if (value <= best) return;
      best = value;
      node.vector = number;
    };
    if (node.seen_vectors == 0) {
      bound.for_blind(node.left, take);
      // Plans that assume an impossible state are hardly the best.
      if (bound.initial() > bound.blind()) {
        for (const std::uint32_t state : node.belief.states) take(bound.blind() + state);
      }
      node.seen_vectors = bound.initial();
    }
    work_ += per_passed * (bound.size() - node.seen_vectors);
    for (; node.seen_vectors < bound.size(); ++node.seen_vectors) {
      const AlphaVector& vector = bound[node.seen_vectors];
      if (!vector.is_gone() && vector.length <= node.left) take(node.seen_vectors);
    }
    // What a plan promised that was given up counts no longer: no other belief could build a plan on it.
    node.lower = best;
  }

  [[gnu::optimize("O3")]] void refresh_upper(Node& node) {
    UpperBound& bound = upper_of(node.region, node.left);
    work_ += per_look;
    if (bound.changes() != node.seen_changes) work_ += per_spread * node.belief.size();
    work_ += std::min<std::size_t>(bound.changes() - node.seen_changes, bound.points()) * node.belief.size();
    node.upper = bound.of(node.belief, node.corner, node.upper, node.seen_changes);
    node.seen_changes = bound.changes();
  }

  // The node after an observation in a region of which nothing else is known; `nowhere` if nothing may follow.
  std::uint32_t uninformed_successor(std::uint32_t region, std::uint32_t left, std::uint32_t action,
                                     std::uint32_t observation_branch) {
    const Region& from = regions_.all[region];
    List<std::uint32_t>& known =
        uninformed_[(std::uint64_t{region} * informed_.size() + left) * model_.actions + action];
    if (known.empty()) {
      Belief belief;
      for (std::uint32_t state = 0; state < from.states.size(); ++state) {
        belief.states.push_back(state);
        belief.probabilities.push_back(1.0 / static_cast<double>(from.states.size()));
      }
      Branch branch{action, 0, 0};
      add_successors(belief, left, from.moves[action], branch);
      known.assign(from.moves[action].observation_branches.size(), nowhere);
      for (const Successor& successor : branch.successors) known[successor.observation_branch] = successor.node;
    }
    return known[observation_branch];
  }

 private:
  // Only `kept_bits_` binary digits of a probability count, so that different ways to the same belief meet.
  BeliefKey key_of(std::uint32_t region, std::uint32_t left, const Belief& belief) const {
    BeliefKey key{std::uint64_t{left} << 32 | region};
    const int dropped = 52 - kept_bits_;
    const std::uint64_t half = std::uint64_t{1} << dropped >> 1;
    for (std::size_t i = 0; i < belief.size(); ++i) {
      key.add(belief.states[i], (std::bit_cast<std::uint64_t>(belief.probabilities[i]) + half) >> dropped);
    }
    return key;
  }

  // What takes time whatever the size of a belief.
  static constexpr std::uint64_t per_node = 1400;    // a new one
  static constexpr std::uint64_t per_look_up = 200;  // of a belief
  static constexpr std::uint64_t per_branch = 90;
  static constexpr std::uint64_t per_look = 30;      // at a bound that may have changed
  static constexpr std::uint64_t per_vector = 35;
  static constexpr std::uint64_t per_passed = 2;     // vector that does not count
  static constexpr std::uint64_t per_cleared = 8;    // numbers that an operation clears
  // Of each state of a belief, what is more than a multiplication:
  static constexpr std::uint64_t per_weight = 3;
  static constexpr std::uint64_t per_normalised = 6;
  static constexpr std::uint64_t per_spread = 2;

  // The number of terms in the longest sum that is computed here.
  std::size_t longest_sum() const {
    std::size_t longest = longest_row(model_.outcomes) + longest_row(model_.likelihoods);
    longest = std::max(longest, regions_.largest());
    for (const Region& region : regions_.all) {
      for (const Move& move : region.moves) {
        longest = std::max(longest, move.observation_branches.size());
        for (const ObservationBranch& observation_branch : move.observation_branches) longest = std::max(longest, observation_branch.successors.size());
      }
    }
    return longest;
  }

  void note_size(const AlphaVector& vector) { largest_value_ = std::max(largest_value_, vector.size); }
  const Move& move(const Node& node, std::uint32_t action) const { return regions_.all[node.region].moves[action]; }

  double value_of(const AlphaVector& vector, const Node& node) {
    work_ += per_vector + node.belief.size();
    const double value = expected(vector.values, node.belief) - rounding_ * vector.size;
    return vector.length == node.left ? value : value + tail(vector.length, node.left);
  }

  void add_certainty_equivalent(const ActionValues& blind) {
    const CertaintyEquivalent plans{model_, regions_, informed_.front(), blind, rounding_};
    for (std::uint32_t region = 0; region < lower_.size(); ++region) {
      for (AlphaVector& vector : plans.vectors(region)) {
        note_size(vector);
        lower_[region].add_initial(std::move(vector));
      }
    }
  }

  [[gnu::optimize("O3")]] void add_successors(const Belief& belief, std::uint32_t left, const Move& move, Branch& branch) {
    work_ += posterior_.predict(belief, move) + move.targets / per_cleared;
    for (std::uint32_t number = 0; number < move.observation_branches.size(); ++number) {
      const ObservationBranch& observation_branch = move.observation_branches[number];
      const double total = posterior_.observe(observation_branch);
      work_ += per_look + per_weight * observation_branch.successors.size();
      if (total > negligible_) {
        add_successor(observation_branch.region, left, number, total, branch);
      } else if (total > 0) {
        add_rest(branch, total * (1 + rounding_), upper_of(observation_branch.region, left).highest());
      }
    }
  }

  static void add_rest(Branch& branch, double probability, double highest) {
    branch.rest += probability;
    branch.rest_upper += probability * highest;
  }

  // Adds the successor for the posterior belief, whose weights sum to `total`.
  void add_successor(std::uint32_t region, std::uint32_t left, std::uint32_t observation_branch, double total, Branch& branch) {
    const std::uint32_t number = node_of(region, left, posterior_.normalised(total, negligible_));
    work_ += per_normalised * nodes_[number].belief.size();
    const double share = posterior_.share_of(nodes_[number].belief) * (1 - 4 * rounding_);
    const double rest = std::max(0.0, total - share) + 8 * rounding_ * total;
    branch.successors.push_back({share, observation_branch, number});
    add_rest(branch, rest, upper_of(region, left).highest());
  }

  const FlatModel& model_;
  const Regions& regions_;
  double rounding_;
  double negligible_ = 0;
  int kept_bits_ = 0;
  List<ActionValues> informed_;  // by layer
  List<double> sizes_;           // the largest absolute value of these, by layer
  Tails tails_;
  double largest_value_ = 0;
  List<LowerBound> lower_;                   // by region
  List<std::unique_ptr<UpperBound>> upper_;  // by layer and region; those that were asked for
  std::deque<Node> nodes_;
  std::unordered_map<BeliefKey, std::uint32_t, BeliefKey::Hash> index_;
  std::unordered_map<std::uint64_t, List<std::uint32_t>> uninformed_;  // by region, decisions left, action
  std::size_t bytes_ = 0;
  std::uint64_t work_ = 0;
  Posterior posterior_;
  List<double> dense_;
};

}
