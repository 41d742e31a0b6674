// By which a belief is known again: a key of 128 bits of its states and their rounded probabilities. The order of the states
// does not matter. Who makes a key says what difference of probabilities comes from rounding.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos {

class BeliefKey {
 public:
  // Beliefs at different places, such as with different numbers of decisions to go, are never the same.
  explicit BeliefKey(std::uint64_t place = 0) : high_(mixed(place)), low_(mixed(~place)) {}

  // The parts are summed, so that a processor can begin the next state before this one is finished.
  void add(std::uint32_t state, std::uint64_t probability) {
    high_ += mixed(probability + state * 0xff51afd7ed558ccdu);
    low_ += mixed(probability * 0x2545f4914f6cdd1du ^ ~std::uint64_t{state});
  }

  bool operator==(const BeliefKey&) const = default;

  struct Hash {
    std::size_t operator()(const BeliefKey& key) const { return key.high_ ^ key.low_; }
  };

 private:
  static std::uint64_t mixed(std::uint64_t x) {
    x *= 0x9e3779b97f4a7c15u;
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93u;
    return x ^ (x >> 29);
  }

  std::uint64_t high_, low_;
};

}
