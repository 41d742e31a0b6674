// What a report makes of several beliefs.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/belief/gathering.hpp"

namespace aos {

// Whether two beliefs are the same but for rounding.
template <class Model>
bool are_alike(const Belief<Model>& left, const Belief<Model>& right) {
  Gathering<Model> difference;
  for (const auto& [state, weight] : left.particles()) difference.add(state, weight);
  for (const auto& [state, weight] : right.particles()) difference.add(state, -weight);
  return std::ranges::all_of(difference.particles(), [](const auto& each) { return std::abs(each.weight) < 1e-9; });
}

// A skill by its name, and what it reported: the response and the numbers beside it.
using Report = std::pair<std::string, std::string>;

template <class Model>
struct Posteriors {
  // A belief after an observation, and the logarithm of the observation's probability. The belief is empty if the
  // observation is impossible.
  using One = std::pair<Belief<Model>, double>;

  List<One> each;
  std::optional<One> cautious;

  bool hypotheses_are_empty() const {
    return std::ranges::all_of(each, [](const One& one) { return one.first.particles().empty(); });
  }
  bool has_cautious() const { return cautious && !cautious->first.particles().empty(); }
  // Whether the observation is impossible, whatever ran.
  bool are_empty() const { return hypotheses_are_empty() && !has_cautious(); }
};

}
