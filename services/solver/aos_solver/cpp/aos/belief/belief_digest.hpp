// The digest of a belief: the same for the same states with the same weights, in whatever order they are held.
//
// A weight counts with the 24 bits of a float, so that its digest outlives a sum in another order. Histories and the
// constants of the model do not count.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/belief/belief.hpp"

namespace aos {

inline std::uint64_t canonical_weight(double weight) { return std::bit_cast<std::uint32_t>(static_cast<float>(weight)); }

template <class Model>
std::uint64_t belief_digest(const Belief<Model>& belief) {
  // The sum of a hash of each state takes the place of sorting them.
  std::uint64_t sum = 0;
  for (const auto& [state, weight] : belief.particles()) {
    sum += mixed(mixed(Model::hash(state), canonical_weight(weight)), 0x94d049bb133111ebu);
  }
  return mixed(sum, belief.particles().size());
}

inline std::string digest_text(std::uint64_t digest) {
  constexpr std::array digits{'0', '1', '2', '3', '4', '5', '6', '7', '8', '9', 'a', 'b', 'c', 'd', 'e', 'f'};
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += digits[(digest >> shift) & 0xf];
  return text;
}

}
