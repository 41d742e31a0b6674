// What one simulated step gives, and observations as numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

namespace aos {

// How a state has ended; running states go on.
enum class Ending : std::uint8_t { running, goal, failure };

// >= 0: the number of a response within its skill; -1: no response was set; below: a text.
using Observation = std::int64_t;

inline constexpr Observation default_observation = -1;
inline constexpr const char* default_observation_text = "DefaultObservation";

struct Step {
  double reward = 0;
  Observation observation = default_observation;
};

namespace detail {

// Per thread, without a lock: the numbers depend on the texts alone, so threads agree on them.
inline std::unordered_map<Observation, std::string>& observed_texts() {
  thread_local std::unordered_map<Observation, std::string> texts;
  return texts;
}

}  // namespace detail

// The number of a text observation: 63 bits of FNV-1a, the same in every process.
inline Observation text_observation(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char character : text) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3u;
  }
  auto number = static_cast<Observation>(hash | (std::uint64_t{1} << 63));
  if (number == default_observation) --number;
  // Most texts come again soon.
  thread_local std::array<Observation, 256> recent{};
  Observation& last = recent[static_cast<std::size_t>(number) % recent.size()];
  if (last != number) detail::observed_texts().try_emplace(last = number, text);
  return number;
}

// The text behind a number that this thread has made; empty if it has not.
inline std::string_view observation_text(Observation number) {
  const auto& texts = detail::observed_texts();
  const auto known = texts.find(number);
  return known == texts.end() ? std::string_view{} : std::string_view{known->second};
}

}  // namespace aos
