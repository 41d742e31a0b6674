// Translates the model's numbers into the words of the documents, and back.
#pragma once

#include "aos/child/command.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/step.hpp"
#include "aos/text/json.hpp"

namespace aos {

// Returns the number of an action or a monitor. Throws BadCommand if there is no such action.
template <class Model>
int checked_action(int action) {
  const int count = is_monitor(action) ? first_monitor + Model::monitor_count() : Model::action_count();
  if (action < 0 || action >= count) throw BadCommand{"there is no such action"};
  return action;
}
template <class Model>
int action_of(const Command& command) { return checked_action<Model>(command.number<int>("action")); }

// The command's horizon; that of the documents where it names none.
template <class Model>
int horizon_of(const Command& command) {
  const int horizon = command.number<int>("horizon");
  return horizon > 0 ? horizon : Model::horizon;
}

template <class Model>
std::string text_of_response(int action, Observation observation) {
  return name_of_observation<Model>(Model::skill_of(action), observation);
}

template <class Model>
Observation observation_of(int action, std::string_view response) {
  const int skill = Model::skill_of(action);
  for (int number = 0; number < Model::response_count(skill); ++number) {
    if (response == Model::response_name(skill, number)) return number;
  }
  if (response == default_observation_text) return default_observation;
  if (response == no_observation_text) return no_observation;
  return text_observation(response);
}

inline const char* ending_text(Ending ending) {
  static constexpr const char* texts[ending_count] = {"", "goal", "failure", "over"};
  return texts[static_cast<std::size_t>(ending)];
}

// Writes each number as the index of its name, its index in an array, and its value.
inline void write_numbers(JsonWriter& json, const ObservedNumbers& numbers) {
  json.begin_array();
  for (const auto& [key, value] : numbers) {
    json.begin_array().value(name_of_number(key)).value(index_of_number(key)).value(value).end_array();
  }
  json.end_array();
}

// Reads such numbers from text; all parts are separated by spaces. Throws BadCommand.
inline ObservedNumbers numbers_from(std::string_view text) {
  const auto parts = text.empty() ? List<std::string_view>{} : detail::parts_of(text, ' ');
  if (parts.size() % 3 != 0) throw BadCommand{"a number is not a name, an index and a value"};
  ObservedNumbers numbers;
  for (std::size_t part = 0; part < parts.size(); part += 3) {
    const auto name = detail::number_in<std::uint32_t>(parts[part]);
    const auto key = number_key(name, detail::number_in<std::uint32_t>(parts[part + 1]));
    if (!numbers.add(key, detail::number_in<double>(parts[part + 2]))) throw BadCommand{"a number is given twice"};
  }
  return numbers;
}

}
