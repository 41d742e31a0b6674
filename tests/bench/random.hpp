// xoshiro256++ (Blackman and Vigna), with the draws that the problems need: no division, no floating point.
//
// The engine's generator once more, and on purpose a copy: the baseline is what the engine is measured against, so it
// must draw at the same price and must not change when the engine does.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace bench {

class Random {
 public:
  explicit Random(std::uint64_t seed) {
    for (auto& word : words_) {
      seed += 0x9e3779b97f4a7c15u;
      std::uint64_t mixed = seed;
      mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
      mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
      word = mixed ^ (mixed >> 31);
    }
  }

  std::uint64_t bits() {
    const std::uint64_t result = std::rotl(words_[0] + words_[3], 23) + words_[0];
    const std::uint64_t shifted = words_[1] << 17;
    words_[2] ^= words_[0];
    words_[3] ^= words_[1];
    words_[1] ^= words_[2];
    words_[0] ^= words_[3];
    words_[2] ^= shifted;
    words_[3] = std::rotl(words_[3], 45);
    return result;
  }

  // In [0, bound).
  unsigned below(unsigned bound) { return static_cast<unsigned>((bits() >> 32) * bound >> 32); }
  bool flag(std::uint32_t threshold) { return bits() >> 32 < threshold; }

 private:
  std::array<std::uint64_t, 4> words_;
};

// The threshold below which 32 random bits lie with this probability, which is less than 1.
constexpr std::uint32_t threshold(double probability) { return static_cast<std::uint32_t>(probability * 0x1p32); }

}  // namespace bench
