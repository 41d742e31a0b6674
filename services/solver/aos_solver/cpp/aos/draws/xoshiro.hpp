// Random bits of xoshiro256++ (Blackman and Vigna). The generator is seeded through splitmix64, so that every seed gives
// an independent stream. Missions repeat by it, so what a seed gives never changes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace aos {

class Xoshiro {
 public:
  explicit Xoshiro(std::uint64_t seed) {
    for (auto& word : words_) {
      seed += 0x9e3779b97f4a7c15u;
      std::uint64_t mixed = seed;
      mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
      mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
      word = mixed ^ (mixed >> 31);
    }
  }

  // Whether the same comes next.
  bool operator==(const Xoshiro&) const = default;

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

 private:
  std::array<std::uint64_t, 4> words_;
};

}
