// Corrects the states of a belief by a real observation. A skill may have code for the state given an observation; this
// code reads the local variables of the abstraction mapping. A search never corrects the states that it simulates.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/containers.hpp"
#include "aos/model/state_text.hpp"
#include "aos/model/step.hpp"

namespace aos {

// An array among the local variables; an index out of range is a ModelFault.
template <class T>
struct LocalArray : std::vector<T> {
  decltype(auto) operator[](std::ptrdiff_t index) const { return std::vector<T>::operator[](checked(index)); }
  decltype(auto) at(std::ptrdiff_t index) const { return (*this)[index]; }
  decltype(auto) front() const { return (*this)[0]; }
  decltype(auto) back() const { return (*this)[static_cast<std::ptrdiff_t>(this->size()) - 1]; }

 private:
  std::size_t checked(std::ptrdiff_t index) const {
    if (static_cast<std::size_t>(index) >= this->size()) out_of_range(index, this->size());
    return static_cast<std::size_t>(index);
  }
};

// Reads the values of a skill's local variables.
void read_locals(auto& locals, std::string_view text) {
  StateReader values{text};
  values.read(locals);
  values.finish();
}

// Sets the state variable that has the name of a local variable. A ModelFault gets that name.
void tell(const char* name, auto& variable, const auto& value) {
  try {
    variable = value;
  } catch (const ModelFault& fault) {
    throw ModelFault{fault.code, std::string{name} + ": " + fault.text};
  }
}

// Corrects `next`, the state to which a step led from `before`. The special states are evaluated again on the
// corrected state. A state that had ended before the step stays as it is.
template <class Environment, class Skill, class State>
void correct(const State& before, State& next, const auto& parameters, const auto& locals, auto& random) {
  if (before.aos_ending != Ending::running) return;
  Skill::given_observation(before, next, parameters, locals, random);
  next.aos_ending = Ending::running;
  if constexpr (requires { next.aos_spent; }) next.aos_spent = before.aos_spent;
  Environment::special_states(next, random);
  blame::at(0);
}

}
