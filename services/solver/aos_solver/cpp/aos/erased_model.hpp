// The compiled model behind the table, as the engine's templates want a model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "aos/model_table.hpp"

namespace aos {

// A state of up to `Size` bytes.
template <std::size_t Size>
struct ErasedState {
  alignas(std::uint64_t) std::byte bytes[Size]{};

  friend bool operator==(const ErasedState& left, const ErasedState& right) {
    return compiled_model.equal(left.bytes, right.bytes);
  }
};

template <std::size_t Size>
struct ErasedModel {
  using State = ErasedState<Size>;
  inline static const char* const project = compiled_model.project;
  inline static const int horizon = compiled_model.horizon;
  inline static const double discount = compiled_model.discount;
  inline static const int skill_count = compiled_model.skill_count;
  inline static const bool has_rollout_policy = compiled_model.has_rollout_policy;
  inline static const bool has_state_heuristic = compiled_model.has_state_heuristic;

  static void prepare() { compiled_model.prepare(); }
  static int action_count() { return compiled_model.action_count(); }
  static const char* action_name(int action) { return compiled_model.action_name(action); }
  static int skill_of(int action) { return compiled_model.skill_of(action); }
  static const char* skill_name(int skill) { return compiled_model.skill_name(skill); }
  static int response_count(int skill) { return compiled_model.response_count(skill); }
  static const char* response_name(int skill, int response) { return compiled_model.response_name(skill, response); }
  static bool has_text_response(int skill) { return compiled_model.has_text_response(skill); }
  static void write_parameters(int action, JsonWriter& json) { compiled_model.write_parameters(action, json); }
  static void read_locals(int action, std::string_view text) { compiled_model.read_locals(action, text); }

  static Ending ending(const State& state) { return static_cast<Ending>(state.bytes[compiled_model.ending_offset]); }
  static std::uint64_t hash(const State& state) { return compiled_model.hash(state.bytes); }
  static std::string state_text(const State& state) { return compiled_model.state_text(state.bytes); }
  static std::string save_state(const State& state) { return compiled_model.save_state(state.bytes); }
  static void load_state(State& state, std::string_view saved) { compiled_model.load_state(state.bytes, saved); }
  template <class Visitor>
  static void visit(const State& state, Visitor&& visitor) {
    compiled_model.visit(state.bytes, std::addressof(visitor),
                         [](void* context, const std::string& name, const std::string& text) {
                           (*static_cast<std::remove_reference_t<Visitor>*>(context))(name, text);
                         });
  }
  // Where the state's single values stand, in the order of `visit`.
  static std::vector<Place> places(const State& state) { return compiled_model.places(state.bytes); }

  template <class Random>
  static void initial(State& state, Random& random) {
    functions<Random>().initial(state.bytes, random);
  }
  template <class Random>
  static Step step(State& state, int action, Random& random) {
    return functions<Random>().step(state.bytes, action, random);
  }
  template <class Random>
  static bool meets_precondition(const State& state, int action, Random& random) {
    return functions<Random>().meets_precondition(state.bytes, action, random);
  }
  template <class Random>
  static double rollout_weight(const State& state, int action, Random& random) {
    return functions<Random>().rollout_weight(state.bytes, action, random);
  }
  template <class Random>
  static double state_value(const State& state, Random& random) {
    return functions<Random>().state_value(state.bytes, random);
  }
  template <class Random>
  static void correct(const State& before, State& next, int action, Random& random) {
    functions<Random>().correct(before.bytes, next.bytes, action, random);
  }
  // A whole rollout in one call: see rollout.hpp.
  static double rollout(const State& state, int horizon, Sampler& random) {
    return compiled_model.rollout(state.bytes, horizon, random);
  }
  // Many steps in one call: see walk.hpp.
  static Walked walk(std::uint64_t steps, Sampler& random) { return compiled_model.walk(steps, random); }

 private:
  template <class Random>
  static const DrawingFunctions<Random>& functions() {
    if constexpr (std::is_same_v<Random, Sampler>) {
      return compiled_model.sampling;
    } else {
      return compiled_model.enumerating;
    }
  }
};

}  // namespace aos
