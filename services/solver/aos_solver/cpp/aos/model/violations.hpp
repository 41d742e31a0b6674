// The constraints of a mission. A constraint is a condition that must hardly ever come true. The deploy file
// states it over the state before a step, the action, and the state after the step.
#pragma once

#include <concepts>

#include "aos/model/blame.hpp"

namespace aos {

// A bit for each of the mission's constraints.
using Violations = std::uint32_t;

// The action's parameters if the action is of skill `Named`, else null. Conditions name a skill by this.
template <class Named, class Skill>
const typename Named::aos_Parameters* chosen(const typename Skill::aos_Parameters& parameters) {
  if constexpr (std::same_as<Named, Skill>) {
    return &parameters;
  } else {
    return nullptr;
  }
}

// The bit of constraint `number` if its condition holds, else 0.
Violations violation(int number, std::uint32_t piece, auto&& holds) {
  blame::at(piece);
  const bool is_violated = static_cast<bool>(holds());
  blame::at(0);
  return is_violated ? Violations{1} << number : Violations{0};
}

}
