// A problem as plain sums: what an action is expected to earn in a state, and the ways in which the mission goes on.
// The truth is worked out from this; it shares nothing with the engine but the tables.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "aos/base/list.hpp"
#include "problem.hpp"

namespace exam {

// Sorted by state; the probabilities sum to 1.
using Mass = aos::List<std::pair<std::uint32_t, double>>;

struct Branch {
  int observation;
  std::uint32_t next;
  double probability;
};

// An observation after an action at a belief: how likely it is while the mission goes on, and the belief after it.
struct Reached {
  int observation;
  double probability;
  Mass belief;
};

class Flat {
 public:
  // With `takes_together`, observations that tell the same are one, which is what values need; the first stands for
  // all.
  Flat(const Problem& problem, bool takes_together)
      : problem_(problem), rewards_(problem.rows.size()), branches_(problem.rows.size()) {
    for (std::size_t row = 0; row < problem.rows.size(); ++row) {
      std::map<std::pair<int, std::uint32_t>, double> merged;
      for (const Outcome& outcome : problem.rows[row]) {
        rewards_[row] += outcome.probability * outcome.reward;
        if (!problem.is_running(outcome.next)) continue;
        for (const Reading& reading : problem.sensings[outcome.sensing]) {
          const double probability = outcome.probability * reading.probability;
          if (probability > 0) merged[{reading.observation, outcome.next}] += probability;
        }
      }
      for (const auto& [key, probability] : merged) branches_[row].push_back({key.first, key.second, probability});
    }
    if (takes_together) take_together();
  }

  const Problem& problem() const { return problem_; }
  std::size_t states() const { return problem_.states(); }
  std::size_t actions() const { return problem_.actions; }
  double discount() const { return problem_.discount; }
  double reward(std::size_t state, std::size_t action) const { return rewards_[state * actions() + action]; }
  // Sorted by observation.
  const aos::List<Branch>& branches(std::size_t state, std::size_t action) const {
    return branches_[state * actions() + action];
  }

  // What an action earns, and then what `later` says of the next state.
  double value(std::size_t state, std::size_t action, const aos::List<double>& later) const {
    double value = reward(state, action);
    for (const Branch& branch : branches(state, action)) value += discount() * branch.probability * later[branch.next];
    return value;
  }
  double expected_reward(const Mass& belief, std::size_t action) const {
    double sum = 0;
    for (const auto& [state, weight] : belief) sum += weight * reward(state, action);
    return sum;
  }
  // By observation; beliefs are of the part that goes on.
  aos::List<Reached> reached(const Mass& belief, std::size_t action) const {
    std::map<int, std::map<std::uint32_t, double>> parts;
    for (const auto& [state, weight] : belief) {
      for (const Branch& branch : branches(state, action)) {
        parts[branch.observation][branch.next] += weight * branch.probability;
      }
    }
    aos::List<Reached> result;
    for (const auto& [observation, part] : parts) {
      Reached reached{observation, 0, {part.begin(), part.end()}};
      for (const auto& entry : part) reached.probability += entry.second;
      if (reached.probability <= 0) continue;
      for (auto& entry : reached.belief) entry.second /= reached.probability;
      result.push_back(std::move(reached));
    }
    return result;
  }
  // The observation that stands for this one.
  int observation_branch(std::size_t action, int observation) const {
    const auto found = sights_.find({action, observation});
    return found != sights_.end() ? found->second : observation;
  }

  // The running part of the start, and how likely it is.
  std::pair<Mass, double> start() const {
    std::map<std::uint32_t, double> sum;
    double running = 0;
    for (const Start& start : problem_.starts) {
      if (!problem_.is_running(start.state) || start.probability <= 0) continue;
      sum[start.state] += start.probability;
      running += start.probability;
    }
    Mass belief{sum.begin(), sum.end()};
    for (auto& entry : belief) entry.second /= running;
    return {belief, running};
  }

  double largest_reward() const {
    double largest = 0;
    for (const double reward : rewards_) largest = std::max(largest, std::abs(reward));
    return largest;
  }

 private:
  // Two observations tell the same if each is as likely as the other, times a constant, wherever they are possible.
  void take_together() {
    for (std::size_t action = 0; action < actions(); ++action) {
      std::map<int, aos::List<std::pair<std::uint64_t, double>>> likelihoods;
      for (std::size_t state = 0; state < states(); ++state) {
        for (const Branch& branch : branches(state, action)) {
          likelihoods[branch.observation].emplace_back(state << 32 | branch.next, branch.probability);
        }
      }
      std::map<aos::List<std::int64_t>, int> known;
      for (const auto& [observation, entries] : likelihoods) {
        aos::List<std::int64_t> shape;
        for (const auto& [from_to, probability] : entries) {
          shape.push_back(static_cast<std::int64_t>(from_to));
          shape.push_back(std::llround(1e11 * probability / entries.front().second));
        }
        sights_[{action, observation}] = known.try_emplace(shape, observation).first->second;
      }
      if (known.size() == likelihoods.size()) continue;
      for (std::size_t state = 0; state < states(); ++state) {
        std::map<std::pair<int, std::uint32_t>, double> merged;
        auto& row = branches_[state * actions() + action];
        for (const Branch& branch : row) merged[{observation_branch(action, branch.observation), branch.next}] += branch.probability;
        row.clear();
        for (const auto& [key, probability] : merged) row.push_back({key.first, key.second, probability});
      }
    }
  }

  const Problem& problem_;
  std::map<std::pair<std::size_t, int>, int> sights_;  // by action and observation
  aos::List<double> rewards_;
  aos::List<aos::List<Branch>> branches_;
};

// What so many decisions at random are worth, by state.
inline aos::List<double> random_values(const Flat& flat, int decisions) {
  aos::List<double> values(flat.states(), 0.0);
  for (; decisions > 0; --decisions) {
    aos::List<double> before(values.size(), 0.0);
    before.swap(values);
    for (std::size_t state = 0; state < flat.states(); ++state) {
      if (!flat.problem().is_running(state)) continue;
      for (std::size_t action = 0; action < flat.actions(); ++action) {
        values[state] += flat.value(state, action, before) / static_cast<double>(flat.actions());
      }
    }
  }
  return values;
}

inline double expected(const Mass& belief, const aos::List<double>& values) {
  double sum = 0;
  for (const auto& [state, weight] : belief) sum += weight * values[state];
  return sum;
}

}
