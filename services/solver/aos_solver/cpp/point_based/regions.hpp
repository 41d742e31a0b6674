// The states in regions, by what the robot always knows: every belief lies within one region.
//
// Regions are found and not declared: states that one belief can hold together are united, from the start on over every action
// and observation. If a robot sees its own position, there is a region for each position. Beliefs and alpha vectors then have the
// length of a region (the idea of mixed observability: Ong, Png, Hsu and Lee, 2010). States that are worth nothing under every
// policy (the mission has ended) are in no region: beliefs need not sum to 1.
#pragma once

#include <limits>
#include <numeric>
#include <optional>

#include "aos/base/mixed.hpp"
#include "aos/base/number_index.hpp"
#include "point_based/flat_model.hpp"

namespace aos::point_based {

inline constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

// An observation that may follow an action in a region, and the states in which it may be made.
struct ObservationBranch {
  struct Successor {
    std::uint32_t target;
    std::uint32_t local;  // the state's number in the region that is entered
    double probability;   // of the observation there
  };
  std::uint32_t observation;
  std::uint32_t region;
  bool is_ascending = true;  // the successors' states have ascending numbers
  List<Successor> successors;
};

// An action in a region. A target is a next state with its sensing.
struct Move {
  struct Flow {
    std::uint32_t target;
    double probability;
  };
  List<double> rewards;  // by local state
  std::optional<double> sure_reward;  // where it is the same in all of these
  Rows<Flow> flows;             // by local state
  std::size_t targets = 0;
  List<ObservationBranch> observation_branches;
};

struct Region {
  List<std::uint32_t> states;
  List<Move> moves;  // by action
};

class Regions {
 public:
  explicit Regions(const FlatModel& model)
      : region_of(model.states, nowhere),
        local_of(model.states, nowhere),
        model_(model),
        parent_(model.states),
        is_united_(model.states) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    is_worthless_ = worthless_states();
    find_reached();
    for (const Start& start : model.starts) unite_start(start);
    while (unite_successors()) {}
    number();
    for (Region& region : all) add_moves(region);
  }

  // Whether nothing can be earned or lost from a state on.
  bool is_worthless(std::uint32_t state) const { return is_worthless_[state]; }
  // How many states the largest region has.
  std::size_t largest() const {
    std::size_t largest = 0;
    for (const Region& region : all) largest = std::max(largest, region.states.size());
    return largest;
  }

  List<Region> all;
  List<std::uint32_t> region_of;  // of a state; nowhere if it is worthless or never reached
  List<std::uint32_t> local_of;   // a state's number in its region

 private:
  // The largest set of states without rewards that no action leaves: those from which no reward can be reached.
  std::vector<bool> worthless_states() const {
    const Rows<std::uint32_t> before = predecessors();
    std::vector<bool> worthless(model_.states, true);
    List<std::uint32_t> found;
    const auto find = [&](std::uint32_t state) {
      if (!worthless[state]) return;
      worthless[state] = false;
      found.push_back(state);
    };
    for (std::uint32_t state = 0; state < model_.states; ++state) {
      if (std::ranges::any_of(model_.of_actions(model_.rewards, state), [](double reward) { return reward != 0; })) find(state);
    }
    while (!found.empty()) {
      const std::uint32_t state = found.back();
      found.pop_back();
      for (const std::uint32_t earlier : before[state]) find(earlier);
    }
    return worthless;
  }

  // The states from which each state is entered.
  Rows<std::uint32_t> predecessors() const {
    Rows<std::uint32_t> before;
    before.first.assign(model_.states + 1, 0);
    for (std::size_t state = 0; state < model_.states; ++state) {
      for (const Outcome& outcome : model_.outcomes_of(state)) ++before.first[outcome.next + 1];
    }
    std::partial_sum(before.first.begin(), before.first.end(), before.first.begin());
    before.elements.resize(before.first.back());
    auto next = before.first;
    for (std::uint32_t state = 0; state < model_.states; ++state) {
      for (const Outcome& outcome : model_.outcomes_of(state)) before.elements[next[outcome.next]++] = state;
    }
    return before;
  }

  // The number of a key; a new key gets `number`. Different keys have different hashes.
  static std::uint32_t number_of(NumberIndex& index, std::uint64_t key, std::uint32_t number) {
    return index.find_or_add(mixed(0, key), number, [](std::uint32_t) { return true; });
  }

  // Lists the reached states in the order of the decisions that it takes to get there.
  void find_reached() {
    is_reached_.assign(model_.states, false);
    const auto reach = [&](std::uint32_t state) {
      if (is_reached_[state] || is_worthless_[state]) return;
      is_reached_[state] = true;
      reached_.push_back(state);
    };
    for (const Start& start : model_.starts) {
      for (const auto& [state, probability] : start.belief) reach(state);
    }
    for (std::size_t i = 0; i < reached_.size(); ++i) {
      for (const Outcome& outcome : model_.outcomes_of(reached_[i])) reach(outcome.next);
    }
  }

  std::uint32_t root_of(std::uint32_t state) {
    while (parent_[state] != state) state = parent_[state] = parent_[parent_[state]];
    return state;
  }

  bool unite(std::uint32_t left, std::uint32_t right) {
    left = root_of(left);
    right = root_of(right);
    if (left == right) return false;
    parent_[std::max(left, right)] = std::min(left, right);
    is_united_[left] = is_united_[right] = true;
    return true;
  }

  void unite_start(const Start& start) {
    std::uint32_t first = nowhere;
    for (const auto& [state, probability] : start.belief) {
      if (is_worthless_[state]) continue;
      if (first == nowhere) first = state;
      unite(first, state);
    }
  }

  // Passes once over all outcomes. Returns whether any states were united. A state that is alone has a table of its
  // own: where the robot sees everything, a common table would have as many entries as there are outcomes.
  bool unite_successors() {
    bool has_united = false;
    NumberIndex of_regions;  // where an observation after an action leads
    NumberIndex of_one;
    for (const std::uint32_t state : reached_) {
      for (std::size_t action = 0; action < model_.actions; ++action) {
        const std::size_t row = model_.row(state, action);
        const bool is_alone = !is_united_[state];
        if (is_alone && model_.outcomes[row].size() < 2) continue;
        if (is_alone) of_one.clear();
        NumberIndex& successor = is_alone ? of_one : of_regions;
        const std::uint64_t first_key = std::uint64_t{root_of(state)} << 32 | (action * model_.observations);
        for (const auto& outcome : model_.outcomes[row]) {
          if (is_worthless_[outcome.next]) continue;
          for (const auto& likelihood : model_.likelihoods[outcome.sensing]) {
            const std::uint32_t next = number_of(successor, first_key + likelihood.observation, outcome.next);
            if (next != outcome.next && unite(next, outcome.next)) has_united = true;
          }
        }
      }
    }
    return has_united;
  }

  void number() {
    for (std::uint32_t state = 0; state < model_.states; ++state) {
      if (!is_reached_[state]) continue;
      const std::uint32_t root = root_of(state);
      if (root == state) {
        region_of[root] = static_cast<std::uint32_t>(all.size());
        all.emplace_back();
      }
      List<std::uint32_t>& states = all[region_of[root]].states;
      region_of[state] = region_of[root];
      local_of[state] = static_cast<std::uint32_t>(states.size());
      states.push_back(state);
    }
  }

  void add_moves(Region& region) {
    for (std::size_t action = 0; action < model_.actions; ++action) {
      Move move;
      targets_.clear();
      branches_.clear();
      move.flows.first.push_back(0);
      for (const std::uint32_t state : region.states) {
        const std::size_t row = model_.row(state, action);
        move.rewards.push_back(model_.rewards[row]);
        for (const auto& outcome : model_.outcomes[row]) {
          if (is_worthless_[outcome.next]) continue;
          const std::uint64_t key = std::uint64_t{outcome.next} << 32 | outcome.sensing;
          const std::uint32_t known = targets_.size();
          const std::uint32_t target = number_of(targets_, key, known);
          move.flows.elements.push_back({target, outcome.probability});
          if (target == known) add_target(move, outcome, target);
        }
        move.flows.first.push_back(move.flows.elements.size());
      }
      move.targets = targets_.size();
      if (std::ranges::all_of(move.rewards, [&](double reward) { return reward == move.rewards.front(); })) move.sure_reward = move.rewards.front();
      region.moves.push_back(std::move(move));
    }
  }

  void add_target(Move& move, const Outcome& outcome, std::uint32_t target) {
    for (const auto& likelihood : model_.likelihoods[outcome.sensing]) {
      const auto known = static_cast<std::uint32_t>(move.observation_branches.size());
      const std::uint32_t number = number_of(branches_, likelihood.observation, known);
      if (number == known) move.observation_branches.push_back({likelihood.observation, region_of[outcome.next], true, {}});
      auto& [observation, region, is_ascending, successors] = move.observation_branches[number];
      const std::uint32_t local = local_of[outcome.next];
      if (!successors.empty() && successors.back().local >= local) is_ascending = false;
      successors.push_back({target, local, likelihood.probability});
    }
  }

  const FlatModel& model_;
  List<std::uint32_t> parent_;  // of a state, in the forest of united states
  std::vector<bool> is_united_;        // with another state
  std::vector<bool> is_worthless_;
  std::vector<bool> is_reached_;
  List<std::uint32_t> reached_;
  NumberIndex targets_;   // of an action in a region
  NumberIndex branches_;  // of that action's observations
};

}
