// The command that asks an engine child about the mission's constraints.
#pragma once

#include "aos/belief/risks.hpp"
#include "aos/child/command.hpp"
#include "aos/text/json.hpp"

namespace aos {

// Writes, for each action, the probability of violating each constraint in the next step. `is_sampled` tells
// that some of the probabilities are estimates. The seed serves these estimates alone.
template <class Model>
void write_risks(JsonWriter& json, const Command& command, const Belief<Model>& belief) {
  Sampler random{command.number<std::uint64_t>("seed")};
  const std::size_t actions = Model::action_count();
  const std::size_t max_paths = max_enumerated_paths / std::max<std::size_t>(actions, 1);
  bool is_sampled = false;
  json.begin_object().key("actions").begin_array();
  for (int action = 0; action < Model::action_count(); ++action) {
    const Risks risks = risks_of(belief, action, max_paths, random);
    is_sampled = is_sampled || risks.is_sampled;
    json.begin_array();
    for (const double probability : risks.probabilities) json.value(std::clamp(probability, 0.0, 1.0));
    json.end_array();
  }
  json.end_array().member("is_sampled", is_sampled).end_object();
}

}
