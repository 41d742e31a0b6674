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

  const auto& holds(const auto& condition) { return counted(condition, true); }
  const auto& fails(const auto& condition) { return counted(condition, false); }
  // What a block asks for counts where the block is not entered, too.
  static bool entered(const auto& /*condition*/) { return true; }

 private:
  // What is no truth value, such as a text that is compared later, does not count.
  const auto& counted(const auto& condition, bool wanted) {
    if constexpr (requires { condition ? 1 : 0; }) met += (condition ? true : false) == wanted ? 1 : 0;
    return condition;
  }
};

// `a & evaluate_all & b` is `a && b`, and `a | evaluate_all | b` is `a || b`, but `b` is always evaluated.
struct EvaluateAll {};
inline constexpr EvaluateAll evaluate_all;
struct Truth {
  bool value;
  operator bool() const { return value; }
};
Truth operator&(const auto& left, EvaluateAll) { return {left ? true : false}; }
Truth operator|(const auto& left, EvaluateAll) { return {left ? true : false}; }
inline Truth operator&(Truth left, EvaluateAll) { return left; }
inline Truth operator|(Truth left, EvaluateAll) { return left; }
Truth operator&(Truth left, const auto& right) { return {(right ? true : false) && left.value}; }
Truth operator|(Truth left, const auto& right) { return {(right ? true : false) || left.value}; }

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
