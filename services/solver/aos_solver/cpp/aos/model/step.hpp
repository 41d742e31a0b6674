// What one simulated step gives, and observations as numbers.
#pragma once

#include <cstdint>
#include <string_view>

namespace aos {

// How a state has ended; running states go on. `over` is neither a goal nor a failure.
enum class Ending : std::uint8_t { running, goal, failure, over };
inline constexpr int ending_count = 4;

// >= 0: the number of a response within its skill; -1: no response was set; below: a text.
using Observation = std::int64_t;

inline constexpr Observation default_observation = -1;
inline constexpr const char* default_observation_text = "DefaultObservation";

struct Step {
  double reward = 0;
  Observation observation = default_observation;

  bool operator==(const Step&) const = default;
};

// The number of a text observation: 63 bits of FNV-1a, the same in every process.
Observation text_observation(std::string_view text);

// The text behind a number that this thread has made; empty if it has not.
std::string_view observation_text(Observation number);

}  // namespace aos
