// What one simulated step gives, and observations as numbers.
#pragma once

#include <cstdint>
#include <string>
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

// The text response of the step that runs in this thread, as far as it is written; null where none is.
inline thread_local const std::string* response_text = nullptr;
// Where the whole text is put when the step is over, if somebody wants it.
inline thread_local std::string* finished_text = nullptr;

// As long as it lives, the texts of responses are put there.
class WholeText {
 public:
  explicit WholeText(std::string& place) { finished_text = &place; }
  WholeText(const WholeText&) = delete;
  WholeText& operator=(const WholeText&) = delete;
  ~WholeText() { finished_text = nullptr; }
};

// Whether this thread remembers the texts that it makes numbers of.
inline thread_local bool remembers_texts = true;

// As long as it lives, texts are not remembered: those of many steps that nobody asks for.
class ForgottenTexts {
 public:
  ForgottenTexts() { remembers_texts = false; }
  ForgottenTexts(const ForgottenTexts&) = delete;
  ForgottenTexts& operator=(const ForgottenTexts&) = delete;
  ~ForgottenTexts() { remembers_texts = true; }
};

// The number of a text observation: 63 bits of FNV-1a, the same in every process.
Observation text_observation(std::string_view text);

// The text behind a number that this thread has made; empty if it has not.
std::string_view observation_text(Observation number);

// What a skill's documents call an observation.
template <class Model>
std::string name_of_observation(int skill, Observation observation) {
  if (observation >= 0) return Model::response_name(skill, static_cast<int>(observation));
  if (observation == default_observation) return default_observation_text;
  return std::string{observation_text(observation)};
}

}  // namespace aos
