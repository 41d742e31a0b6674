// The results of one simulated step. Observations are numbers.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "aos/base/set_for_now.hpp"

namespace aos {

// How a state has ended. A running state goes on; `over` is neither a goal nor a failure.
enum class Ending : std::uint8_t { running, goal, failure, over };
inline constexpr int ending_count = 4;

// From 0 on: the index of a response within its skill. -1: no response was set. Below -1: a text.
using Observation = std::int64_t;

inline constexpr Observation default_observation = -1;
inline constexpr const char* default_observation_text = "DefaultObservation";

// Nobody observes a step that never ends: see endless_steps.hpp.
inline constexpr Observation no_observation = std::numeric_limits<Observation>::min();
inline constexpr const char* no_observation_text = "(never ends)";

// The number that stands for no action where a belief is updated: time passes, and nothing is observed.
inline constexpr int no_action = -1;

// Monitors are asked like actions: these are their numbers, from here on. No list of actions has them, so that nobody
// plans with them.
inline constexpr int first_monitor = 1 << 24;
inline constexpr bool is_monitor(int action) { return action >= first_monitor; }

struct Step {
  double reward = 0;
  Observation observation = default_observation;

  bool operator==(const Step&) const = default;
};

// The text response of the step that runs in this thread, as far as it is written; null if there is none.
inline thread_local const std::string* response_text = nullptr;
// Where the complete text is stored at the end of the step; null if nobody wants it.
inline thread_local std::string* finished_text = nullptr;

// As long as this object lives, the complete texts of responses are stored in `place`.
struct WholeText : SetForNow<std::string*> {
  explicit WholeText(std::string& place) : SetForNow(finished_text, &place) {}
};

// Whether this thread remembers the texts of text observations.
inline thread_local bool remembers_texts = true;

// As long as this object lives, texts are not remembered. It serves long runs whose texts nobody asks for.
struct ForgottenTexts : SetForNow<bool> {
  ForgottenTexts() : SetForNow(remembers_texts, false) {}
};

// The number of a text observation: 63 bits of FNV-1a, the same in every process.
Observation text_observation(std::string_view text);

// The text behind a number that this thread has made; empty for any other number.
std::string_view observation_text(Observation number);

// The name of an observation in the documents of a skill.
template <class Model>
std::string name_of_observation(int skill, Observation observation) {
  if (observation >= 0) return Model::response_name(skill, static_cast<int>(observation));
  if (observation == default_observation) return default_observation_text;
  if (observation == no_observation) return no_observation_text;
  return std::string{observation_text(observation)};
}

}
