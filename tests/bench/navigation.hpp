// The paper's example, as in deploy/bundles/bench/navigation: a robot that may lose its way visits three places.
#pragma once

#include <cmath>

#include "problem.hpp"
#include "random.hpp"

namespace bench {

struct Navigation {
  static constexpr const char* name = "navigation";
  static constexpr int action_count = 3;  // to each of the places
  static constexpr int observation_count = 2;
  static constexpr int depth = 10;
  static constexpr double discount = 0.97;
  static constexpr double exploration = 7000;
  static constexpr bool has_knowledge = false;

  struct State {
    std::uint8_t at = lost;  // a place
    std::uint8_t visited = 0;  // a set of places
    bool is_scolded = false;
  };

  static State start(Random& random) {
    State state;
    state.at = random.flag(threshold(0.5)) ? 0 : random.flag(threshold(0.2)) ? 1 : 2;
    return state;
  }

  static Outcome step(State& state, int action, Random& random) {
    // One draw in two halves: whether it is pushed away, and whether it misses its way.
    const std::uint64_t bits = random.bits();
    const bool is_elsewhere = state.at != action;
    const int left_from = static_cast<std::uint32_t>(bits) < threshold(0.05) ? static_cast<int>(lost) : state.at;
    const bool arrives = is_elsewhere & (bits >> 32 >= threshold(0.1));
    Outcome outcome;
    outcome.reward = (arrives ? cost[left_from][action] : -10.0f) + (is_elsewhere ? 0.0f : -10.0f);
    state.at = arrives ? static_cast<std::uint8_t>(action) : static_cast<std::uint8_t>(lost);
    state.visited |= static_cast<std::uint8_t>(arrives << action);
    outcome.observation = arrives || random.flag(threshold(0.2));
    if ((state.visited & 0b11) == 0b10 && !state.is_scolded) {
      state.is_scolded = true;
      outcome.reward -= 50;
    }
    if (state.visited == 0b111) {
      outcome.reward += 7000;
      outcome.ends = true;
    }
    return outcome;
  }

  static int legal_action(const State& state, Random& random) {
    if (state.at == lost) return static_cast<int>(random.below(action_count));
    const int other = static_cast<int>(random.below(action_count - 1));
    return other + (other >= state.at);
  }
  static int promising_action(const State& state, Random& random) { return legal_action(state, random); }

 private:
  static constexpr int lost = 3;
  static constexpr std::array<double, 3> x{-1.0, 0.0, 1.0};
  static constexpr std::array<double, 3> y{0.66, 0.64, 0.61};

  // From each place, and from wherever it is when it is lost.
  static std::array<std::array<float, 3>, 4> costs() {
    std::array<std::array<float, 3>, 4> all{};
    all[lost].fill(-5);
    for (int from = 0; from < 3; ++from) {
      for (int to = 0; to < 3; ++to) {
        all[from][to] = static_cast<float>(-100 * std::hypot(x[from] - x[to], y[from] - y[to]));
      }
    }
    return all;
  }
  inline static const std::array<std::array<float, 3>, 4> cost = costs();
};

}
