// A key of 128 bits by which a belief graph finds a belief again.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "point_based/bounds.hpp"

namespace aos::point_based {

struct BeliefKey {
  std::uint64_t high, low;
  bool operator==(const BeliefKey&) const = default;
};

struct BeliefKeyHash {
  std::size_t operator()(const BeliefKey& key) const { return key.high ^ key.low; }
};

// Only `kept_bits` binary digits of a probability count, so that different ways to the same belief meet.
inline BeliefKey key_of(std::uint32_t region, std::uint32_t left, const Belief& belief, int kept_bits) {
  const auto mixed = [](std::uint64_t x) {
    x *= 0x9e3779b97f4a7c15u;
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93u;
    return x ^ (x >> 29);
  };
  BeliefKey key{mixed(std::uint64_t{left} << 32 | region), mixed(~(std::uint64_t{left} << 32 | region))};
  const int dropped = 52 - kept_bits;
  const std::uint64_t half = std::uint64_t{1} << dropped >> 1;
  for (std::size_t i = 0; i < belief.size(); ++i) {
    // The parts are summed, so that a processor can begin the next state before this one is finished.
    const std::uint64_t rounded = (std::bit_cast<std::uint64_t>(belief.probabilities[i]) + half) >> dropped;
    key.high += mixed(rounded + belief.states[i] * 0xff51afd7ed558ccdu);
    key.low += mixed(rounded * 0x2545f4914f6cdd1du ^ ~std::uint64_t{belief.states[i]});
  }
  return key;
}

}  // namespace aos::point_based
