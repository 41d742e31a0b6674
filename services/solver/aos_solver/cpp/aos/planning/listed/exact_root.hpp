// The belief from which exact values are computed.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "numbers/exact.hpp"

namespace aos {

// The belief as numbers of listed states. Throws NotEnumerable where it has no exact values.
template <class Model>
Weighted exact_root(const StateSpace<Model>& space, const Belief<Model>& belief) {
  if (!space.lists_observations()) throw NotEnumerable{numbers_are_observed};
  if (space.estimates_draws()) throw NotEnumerable{"draws are continuous"};
  if (!belief.is_exact()) throw NotEnumerable{"the belief is only known by samples"};
  return space.weights_of(belief);
}

}
