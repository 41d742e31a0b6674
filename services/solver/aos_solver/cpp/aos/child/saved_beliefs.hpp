// Beliefs as text, for an engine whose model has the same states: of the same documents, or of changed ones.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/state_text.hpp"

namespace aos {

inline constexpr std::size_t most_answer_bytes = std::size_t{16} << 20;  // about

// The particles from number `first` on, as many as fit one answer, each as its weight and its state as text. What is the
// same in all states, and the states that nothing was observed of, only with the first of them. `told` gives what is told
// of a state.
template <class Model, class Told>
void save_belief(JsonWriter& json, const Belief<Model>& belief, std::size_t first, Told&& told) {
  const auto& particles = belief.particles();
  const SavedConstants constants = first == 0 ? Model::save_constants() : SavedConstants{};
  json.begin_object().member("error_bound", belief.error_bound()).member("is_drawn", belief.is_drawn());
  json.member("states", particles.size()).key("constants").begin_object();
  for (const auto& [name, text] : constants.texts()) json.member(name, text);
  json.end_object().key("unobserved").begin_array();
  if (first == 0) {
    for (const auto& state : belief.unobserved().states()) json.value(Model::save_state(state));
  }
  json.end_array().key("particles").begin_array();
  const std::size_t most_bytes = json.text().size() + most_answer_bytes;
  for (std::size_t number = first; number < particles.size() && json.text().size() < most_bytes; ++number) {
    const auto& [state, weight] = particles[number];
    json.begin_array().value(weight).value(Model::save_state(told(state))).end_array();
  }
  json.end_array().end_object();
}

// How many of the fields of a saved belief are what.
struct SavedCounts {
  std::size_t constants;
  std::size_t unobserved;
};

// Of fields in this order: pairs of a constant's name and text, states that nothing was observed of, pairs of a weight and
// a state.
template <class Model>
Belief<Model> load_belief(double error_bound, bool is_drawn, SavedCounts counts,
                          const std::vector<std::string_view>& fields, Sampler& random) {
  SavedConstants constants;
  std::size_t next = 0;
  for (; next + 1 < fields.size() && next < 2 * counts.constants; next += 2) {
    constants.add_text(fields[next], fields[next + 1]);
  }
  const auto state_of = [&](std::string_view text) {
    typename Model::State state{};
    Model::load_state(state, text, constants);
    return state;
  };
  std::vector<typename Model::State> unobserved;
  for (; next < fields.size() && unobserved.size() < counts.unobserved; ++next) {
    unobserved.push_back(state_of(fields[next]));
  }
  std::vector<Particle<Model>> particles;
  for (; next + 1 < fields.size(); next += 2) {
    particles.push_back({state_of(fields[next + 1]), std::stod(std::string{fields[next]})});
  }
  return Belief<Model>::of(particles, {std::move(unobserved), random}, error_bound, is_drawn);
}

}  // namespace aos
