// The draws that the problems need, of the engine's random bits: no division, no floating point.
#pragma once

#include "aos/draws/xoshiro.hpp"

namespace bench {

class Random : public aos::Xoshiro {
 public:
  using Xoshiro::Xoshiro;

  // In [0, bound).
  unsigned below(unsigned bound) { return static_cast<unsigned>((bits() >> 32) * bound >> 32); }
  bool flag(std::uint32_t threshold) { return bits() >> 32 < threshold; }
};

// The threshold below which 32 random bits lie with this probability, which is less than 1.
constexpr std::uint32_t threshold(double probability) { return static_cast<std::uint32_t>(probability * 0x1p32); }

}
