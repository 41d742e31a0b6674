// Beliefs as text, for an engine whose model has the same states. Its documents are the same, or changed ones.
#pragma once

#include "aos/belief/saved_history.hpp"
#include "aos/model/state_text.hpp"
#include "aos/text/base64.hpp"
#include "aos/text/json.hpp"

namespace aos {

inline constexpr std::size_t max_answer_bytes = std::size_t{16} << 20;  // about: the last particle may exceed it

// Writes the particles from number `first` on, as many as fit one answer, each as its weight and its state as text. The
// constants and the history of a drawn belief come only with particle 0. `shown(state)` gives the state to write. With
// `max_bytes` of its own an answer that would be longer lacks particles.
template <class Model, class Shown>
void save_belief(JsonWriter& json, const Belief<Model>& belief, std::size_t first, Shown&& shown,
                 std::size_t max_answer = max_answer_bytes) {
  constexpr std::size_t least_bytes_of_particle = 8;
  const auto& particles = belief.particles();
  const bool is_too_long = particles.size() * least_bytes_of_particle > max_answer && max_answer < max_answer_bytes;
  const bool has_head = first == 0 && !is_too_long;
  const SavedConstants constants = has_head ? Model::save_constants() : SavedConstants{};
  json.begin_object().member("error_bound", belief.error_bound()).member("is_drawn", belief.is_drawn());
  json.member("states", particles.size()).key("constants").begin_object();
  for (const auto& [name, text] : constants.texts()) json.member(name, text);
  json.end_object().member("history", has_head ? to_base64(saved_history(belief)) : std::string{});
  json.key("particles").begin_array();
  const std::size_t max_bytes = is_too_long ? 0 : max_answer < max_answer_bytes ? max_answer : json.text().size() + max_answer_bytes;
  for (std::size_t number = first; number < particles.size() && json.text().size() < max_bytes; ++number) {
    const auto& [state, weight] = particles[number];
    json.begin_array().value(weight).value(Model::save_state(shown(state))).end_array();
  }
  json.end_array().end_object();
}

// Reads what `save_belief` wrote. `fields` are `constant_count` pairs of a constant's name and text, then
// pairs of a weight and a state.
template <class Model>
Belief<Model> load_belief(double error_bound, bool is_drawn, std::string_view history, std::size_t constant_count,
                          const List<std::string_view>& fields) {
  SavedConstants constants;
  std::size_t next = 0;
  for (; next + 1 < fields.size() && next < 2 * constant_count; next += 2) {
    constants.add(fields[next], fields[next + 1]);
  }
  List<Particle<Model>> particles;
  for (; next + 1 < fields.size(); next += 2) {
    typename Model::State state{};
    Model::load_state(state, fields[next + 1], constants);
    particles.push_back({state, std::stod(std::string{fields[next]})});
  }
  const Words words = from_base64<std::uint64_t>(history).value_or(Words{});
  return Belief<Model>::of(with_history<Model>(std::move(particles), words), error_bound, is_drawn);
}

}
