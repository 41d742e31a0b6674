// Events that a mission must hardly ever bring about: conditions of its deploy file over the state before a step, the
// action, and the state that the step leads to.
#pragma once

#include <concepts>
#include <cstdint>

#include "aos/model/blame.hpp"

namespace aos {

// A bit for each of the mission's constraints.
using Violations = std::uint32_t;

// How a condition names a skill: a pointer to the parameters of the action, null where the action is of another skill.
template <class Named, class Skill>
const typename Named::Parameters* chosen(const typename Skill::Parameters& parameters) {
  if constexpr (std::same_as<Named, Skill>) {
    return &parameters;
  } else {
    return nullptr;
  }
}

// The bit of constraint `number` where its condition holds.
template <class Condition>
Violations violation(int number, std::uint32_t piece, Condition&& holds) {
  blame::at(piece);
  const bool is_violated = static_cast<bool>(holds());
  blame::at(0);
  return is_violated ? Violations{1} << number : Violations{0};
}

}  // namespace aos
