// Tiger, as in deploy/bundles/bench/tiger.
#pragma once

#include "problem.hpp"
#include "random.hpp"

namespace bench {

struct Tiger {
  static constexpr const char* name = "tiger";
  static constexpr int action_count = 3;  // listen, open left, open right
  static constexpr int observation_count = 2;
  static constexpr int depth = 90;
  static constexpr double discount = 0.95;
  static constexpr double exploration = 500;
  static constexpr bool has_knowledge = false;

  struct State {
    std::uint32_t tiger;  // 0 behind the left door, 1 behind the right one
  };

  static State start(Random& random) { return {static_cast<std::uint32_t>(random.bits() >> 63)}; }

  // Without branches, which random actions would mispredict: the high half of the draw is the report, the lowest bit the
  // next tiger.
  static Outcome step(State& state, int action, Random& random) {
    static constexpr float rewards[action_count][2] = {{-1, -1}, {-100, 10}, {10, -100}};
    const std::uint64_t bits = random.bits();
    const auto is_false = static_cast<std::uint32_t>(bits >> 32 >= threshold(0.85));
    const std::uint32_t is_listening = action == 0;
    const Outcome outcome{rewards[action][state.tiger], static_cast<int>((state.tiger ^ is_false) & is_listening), false};
    state.tiger = is_listening ? state.tiger : static_cast<std::uint32_t>(bits & 1);
    return outcome;
  }

  static int legal_action(const State&, Random& random) { return static_cast<int>(random.below(action_count)); }
  static int promising_action(const State& state, Random& random) { return legal_action(state, random); }
};

}
