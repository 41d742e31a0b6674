// POMCP (Silver and Veness, 2010) as bare as it can be: UCB1, one new history a simulation, a play-out from it. All
// histories are in one array that is reset by setting its length to 0; the children of an action are an array over the
// observations.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "problem.hpp"
#include "random.hpp"

namespace bench {

template <class Problem, PlayOut play_out>
class Pomcp {
 public:
  using State = typename Problem::State;

  explicit Pomcp(std::uint32_t most_simulations)
      : histories_(std::make_unique_for_overwrite<History[]>(most_simulations + 1)) {}

  // Searches from a fresh root at the initial belief. Returns the root's best action.
  int search(std::uint32_t simulations, Random& random) {
    length_ = 0;
    add_history();
    for (std::uint32_t done = 0; done < simulations; ++done) simulate(random);
    const History& root = histories_[0];
    int best = 0;
    for (int action = 1; action < Problem::action_count; ++action) {
      if (root.value[action] > root.value[best]) best = action;
    }
    return best;
  }

  std::uint64_t steps() const { return steps_; }

 private:
  static constexpr std::uint32_t none = 0;  // the root is nobody's child

  // One entry for each action, so that the loops over them run in vector registers.
  struct History {
    std::uint32_t visits;
    std::array<float, Problem::action_count> value;
    std::array<float, Problem::action_count> count;
    std::array<std::array<std::uint32_t, Problem::observation_count>, Problem::action_count> child;
  };
  struct Visit {
    std::uint32_t history;
    int action;
    float reward;
  };

  std::uint32_t add_history() {
    History& history = histories_[length_];
    history.visits = 0;
    history.value.fill(0);
    history.count.fill(0);
    for (auto& children : history.child) children.fill(none);
    return length_++;
  }

  void simulate(Random& random) {
    State state = Problem::start(random);
    std::array<Visit, Problem::depth> path;
    int length = 0;
    float later = 0;
    for (std::uint32_t history = 0; length < Problem::depth;) {
      const int action = chosen(histories_[history]);
      const Outcome outcome = Problem::step(state, action, random);
      path[length++] = {history, action, outcome.reward};
      if (outcome.ends) break;
      const std::uint32_t next = histories_[history].child[action][outcome.observation];
      if (next == none) {
        histories_[history].child[action][outcome.observation] = add_history();
        later = played_out(state, Problem::depth - length, random);
        break;
      }
      history = next;
    }
    steps_ += static_cast<std::uint64_t>(length);
    while (length-- > 0) {
      const Visit& visit = path[length];
      History& history = histories_[visit.history];
      later = visit.reward + static_cast<float>(Problem::discount) * later;
      ++history.visits;
      history.count[visit.action] += 1;
      history.value[visit.action] += (later - history.value[visit.action]) / history.count[visit.action];
    }
  }

  static int chosen(const History& history) {
    const float logarithm = std::log(static_cast<float>(history.visits) + 1);
    std::array<float, Problem::action_count> bound;
    for (int action = 0; action < Problem::action_count; ++action) {
      const float count = history.count[action];
      const float bonus = static_cast<float>(Problem::exploration) * std::sqrt(logarithm / count);
      bound[action] = count == 0 ? std::numeric_limits<float>::infinity() : history.value[action] + bonus;
    }
    int best = 0;
    for (int action = 1; action < Problem::action_count; ++action) {
      if (bound[action] > bound[best]) best = action;
    }
    return best;
  }

  float played_out(State& state, int depth, Random& random) {
    float total = 0, weight = 1;
    int left = depth;
    while (left > 0) {
      const int action = play_out == PlayOut::promising ? Problem::promising_action(state, random)
                                                        : Problem::legal_action(state, random);
      const Outcome outcome = Problem::step(state, action, random);
      total += weight * outcome.reward;
      weight *= static_cast<float>(Problem::discount);
      --left;
      if (outcome.ends) break;
    }
    steps_ += static_cast<std::uint64_t>(depth - left);
    return total;
  }

  std::unique_ptr<History[]> histories_;
  std::uint32_t length_ = 0;
  std::uint64_t steps_ = 0;
};

}
