// What a state is worth to somebody who sees it: finite-horizon values of the underlying MDP.
//
// An upper bound for the robot, which sees less, and so a leaf value that makes the search look where it pays. Random
// rollouts say almost nothing in models where most actions are harmful (the QMDP idea: Littman and others, 1995).
// Only for models whose reachable states are few; the others keep their rollouts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/belief.hpp"
#include "aos/clock.hpp"

namespace aos {

inline constexpr std::size_t most_known_states = 20'000;
inline constexpr std::size_t most_known_outcomes = 1'000'000;

template <class Model>
class FullKnowledge {
 public:
  using State = typename Model::State;

  // Prepares values for every number of decisions up to `horizon`. Returns whether the model is small enough, and quick
  // enough for `latest`; a belief whose states are known already costs nothing.
  bool prepare(const Belief<Model>& belief, int horizon, PlanningClock::time_point latest) {
    if (is_too_large_) return false;
    try {
      const std::size_t known = states_.size();
      for (const auto& particle : belief.particles()) number_of(particle.state);
      explore(known, latest);
    } catch (const NotEnumerable&) {
      is_too_large_ = true;
      return false;
    }
    if (values_.empty() || values_.back().size() != states_.size()) values_.assign(1, std::vector<double>(states_.size()));
    while (static_cast<int>(values_.size()) <= horizon) values_.push_back(one_more_decision(values_.back()));
    return true;
  }

  // With `horizon` decisions to go; prepared before.
  double value(const State& state, int horizon) const {
    const auto number = numbers_.find(state);
    return number == numbers_.end() ? 0 : values_[static_cast<std::size_t>(horizon)][number->second];
  }

 private:
  struct Outcomes {
    double reward = 0;
    std::vector<std::pair<std::uint32_t, double>> next;
  };
  struct Hash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };

  std::uint32_t number_of(const State& state) {
    const auto [entry, is_new] = numbers_.try_emplace(state, static_cast<std::uint32_t>(states_.size()));
    if (is_new) {
      if (states_.size() == most_known_states) throw NotEnumerable{"too many states"};
      states_.push_back(state);
    }
    return entry->second;
  }

  void explore(std::size_t from, PlanningClock::time_point latest) {
    Enumerator draws;
    for (std::size_t number = from; number < states_.size(); ++number) {
      if (PlanningClock::now() > latest) throw NotEnumerable{"no time"};
      for (int action = 0; action < Model::action_count(); ++action) {
        Outcomes found;
        if (Model::ending(states_[number]) == Ending::running) {
          draws.for_each_path([&](Enumerator& path) {
            if (++known_outcomes_ > most_known_outcomes) throw NotEnumerable{"too many outcomes"};
            State next = states_[number];
            const Step step = Model::step(next, action, path);
            found.reward += path.probability() * step.reward;
            if (Model::ending(next) == Ending::running) found.next.emplace_back(number_of(next), path.probability());
          });
        }
        outcomes_.push_back(std::move(found));
      }
    }
  }

  std::vector<double> one_more_decision(const std::vector<double>& later) const {
    const auto actions = static_cast<std::size_t>(Model::action_count());
    std::vector<double> values(states_.size());
    for (std::size_t number = 0; number < states_.size(); ++number) {
      double best = -std::numeric_limits<double>::infinity();
      for (std::size_t action = 0; action < actions; ++action) {
        const Outcomes& found = outcomes_[number * actions + action];
        double value = found.reward;
        for (const auto& [next, probability] : found.next) value += Model::discount * probability * later[next];
        best = std::max(best, value);
      }
      values[number] = best;
    }
    return values;
  }

  bool is_too_large_ = false;
  std::size_t known_outcomes_ = 0;
  std::vector<State> states_;
  std::unordered_map<State, std::uint32_t, Hash> numbers_;
  std::vector<Outcomes> outcomes_;
  std::vector<std::vector<double>> values_;
};

}  // namespace aos
