// Finite-horizon values by going through every observation of every action: the truth that the search is measured by.
//
// States are numbered as they appear and each (state, action) is enumerated once. A belief is a sorted list of
// (state number, probability) without its ended part, which is worth nothing; equal beliefs at equal depth are
// evaluated once.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/belief/belief.hpp"

namespace aos {

template <class Model>
class ExactEvaluation {
 public:
  using State = typename Model::State;
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  ExactEvaluation(std::uint64_t belief_budget, double seconds)
      : belief_budget_(belief_budget), latest_(Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds{seconds})) {}

  // The value of every action at the belief with so many decisions to go. Throws NotEnumerable.
  std::vector<double> action_values(const Belief<Model>& belief, int horizon) {
    if (!belief.is_exact()) throw NotEnumerable{"the belief is only known by samples"};
    Weighted root;
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) == Ending::running) root.emplace_back(number_of(state), weight);
    }
    std::sort(root.begin(), root.end());
    std::vector<double> values;
    for (int action = 0; action < Model::action_count(); ++action) {
      values.push_back(horizon > 0 ? action_value(root, action, horizon) : 0);
    }
    return values;
  }

  std::uint64_t beliefs() const { return evaluated_; }
  std::size_t states() const { return states_.size(); }

 private:
  using Weighted = std::vector<std::pair<std::uint32_t, double>>;

  struct Branch {
    Observation observation;
    std::uint32_t next;
    double probability;
    bool is_running;
  };
  struct Outcomes {
    double reward = 0;
    bool is_known = false;
    std::vector<Branch> branches;
  };
  struct StateHash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };
  struct BeliefKey {
    std::uint64_t high, low;
    bool operator==(const BeliefKey&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const BeliefKey& key) const { return key.high ^ key.low; }
  };

  std::uint32_t number_of(const State& state) {
    const auto [entry, is_new] = numbers_.try_emplace(state, static_cast<std::uint32_t>(states_.size()));
    if (is_new) {
      states_.push_back(state);
      outcomes_.emplace_back(Model::action_count());
    }
    return entry->second;
  }

  const Outcomes& outcomes(std::uint32_t number, int action) {
    if (!outcomes_[number][action].is_known) {
      if (Clock::now() > latest_) throw NotEnumerable{"it takes longer than allowed"};
      Outcomes found;
      draws_.for_each_path([&](Enumerator& path) {
        State next = states_[number];
        const Step step = Model::step(next, action, path);
        found.reward += path.probability() * step.reward;
        const bool is_running = Model::ending(next) == Ending::running;
        const std::uint32_t next_number = is_running ? number_of(next) : 0;
        found.branches.push_back({step.observation, next_number, path.probability(), is_running});
      });
      found.is_known = true;
      outcomes_[number][action] = std::move(found);
    }
    return outcomes_[number][action];
  }

  // Beliefs here need not sum to 1: a part's weight is how likely it is to get there.
  double action_value(const Weighted& belief, int action, int horizon) {
    double value = 0;
    std::map<Observation, std::map<std::uint32_t, double>> posteriors;
    for (const auto& [number, weight] : belief) {
      const Outcomes& found = outcomes(number, action);
      value += weight * found.reward;
      if (horizon == 1) continue;
      for (const Branch& branch : found.branches) {
        if (branch.is_running) posteriors[branch.observation][branch.next] += weight * branch.probability;
      }
    }
    for (const auto& [observation, states] : posteriors) {
      value += Model::discount * best_value({states.begin(), states.end()}, horizon - 1);
    }
    return value;
  }

  double best_value(Weighted belief, int horizon) {
    double total = 0;
    for (const auto& part : belief) total += part.second;
    if (total <= negligible_weight) return 0;
    for (auto& part : belief) part.second /= total;

    auto& known = values_[static_cast<std::size_t>(horizon)];
    const BeliefKey key = key_of(belief);
    if (const auto found = known.find(key); found != known.end()) return total * found->second;
    if (++evaluated_ > belief_budget_) throw NotEnumerable{"more beliefs than the budget can be reached"};
    if (evaluated_ % 256 == 0 && Clock::now() > latest_) throw NotEnumerable{"it takes longer than allowed"};
    double best = -std::numeric_limits<double>::infinity();
    for (int action = 0; action < Model::action_count(); ++action) {
      best = std::max(best, action_value(belief, action, horizon));
    }
    known.emplace(key, best);
    return total * best;
  }

  // Probabilities are rounded to 1e-10, so that different orders of the same sum meet.
  static BeliefKey key_of(const Weighted& belief) {
    BeliefKey key{0x9ae16a3b2f90404fu, 0xc949d7c7509e6557u};
    for (const auto& [number, weight] : belief) {
      const auto rounded = static_cast<std::uint64_t>(std::llround(weight * 1e10));
      key.high = mixed(key.high, rounded * 31 + number);
      key.low = mixed(key.low ^ number, rounded);
    }
    return key;
  }

  std::uint64_t belief_budget_;
  Clock::time_point latest_;
  std::uint64_t evaluated_ = 0;
  Enumerator draws_;
  std::vector<State> states_;
  std::unordered_map<State, std::uint32_t, StateHash> numbers_;
  std::vector<std::vector<Outcomes>> outcomes_;
  std::unordered_map<std::size_t, std::unordered_map<BeliefKey, double, KeyHash>> values_;
};

}  // namespace aos
