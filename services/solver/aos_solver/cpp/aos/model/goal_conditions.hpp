// How many conditions of rewards and goals hold in a state: what code says that runs once more and counts them
// (goal_conditions.py).
#pragma once

#include "aos/base/fault.hpp"
#include "aos/model/transition.hpp"

namespace aos {

// Takes the results of code that counts its conditions, of which only the count matters.
struct CountingEffect : EffectWithText {
  int met = 0;
  bool is_goal = false;
  bool is_failure = false;
  bool is_used_up = false;

  auto holds(auto condition) {
    met += condition ? 1 : 0;
    return condition;
  }
  auto fails(auto condition) {
    met += condition ? 0 : 1;
    return condition;
  }
};

namespace detail {

// Runs code that counts. As all conditions are evaluated, code may fail that else would not run: then those before it count.
int conditions_met(auto&& count) {
  CountingEffect effect;
  try {
    count(effect);
  } catch (const ModelFault&) {
  }
  return effect.met;
}

}  // namespace detail

// The conditions of special states that hold.
template <class Environment>
int special_conditions_met(const auto& state, auto& random) {
  return detail::conditions_met([&](CountingEffect& effect) { Environment::goal_conditions(state, effect, random); });
}

// The conditions of a skill's rewards that hold.
template <class Skill>
int skill_conditions_met(const auto& state, const auto& parameters, auto& random) {
  auto before = state;
  auto next = state;
  return detail::conditions_met([&](CountingEffect& effect) {
    bool meets = true;
    Skill::precondition(state, meets, parameters, random);
    Skill::goal_conditions(before, before, next, meets, -1, effect, parameters, random);
  });
}

}  // namespace aos
