// An emitted model on a script: what draws give comes from the script, or from dice. Models are compiled against this
// header, and scripted.cpp is compiled once for all of them. It stands where the engine child stands, so that tests see
// the model alone. Whoever includes it has included aos/model/model_support.hpp, which may be precompiled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <span>
#include <type_traits>

#include "aos/base/list.hpp"

namespace aos {

// Draws from a list: a Bernoulli is true for 1, a discrete draw is the index itself. After the end of the list the
// likelier, or the first, value. Without a list, a quick generator for long walks.
class ScriptedDraws {
 public:
  explicit ScriptedDraws(const char* draws) : rest_(draws) {}
  explicit ScriptedDraws(std::uint64_t seed) : state_(seed) {}

  ScriptedDraws& sensing() { return *this; }
  bool Bernoulli(double probability);
  template <class Weights = std::initializer_list<double>>
  int SampleDiscrete(int name, const Weights& weights) {
    return name + 1 + index(weights, true);
  }
  template <class Enum, class Weights = std::initializer_list<double>>
    requires std::is_enum_v<Enum>
  Enum SampleDiscrete(const Weights& weights) {
    return static_cast<Enum>(index(weights, true));
  }
  template <class Weights = std::initializer_list<double>>
    requires(!std::is_enum_v<Weights>)
  int SampleDiscrete(const Weights& weights) {
    return index(weights, false);
  }
  template <class Value, class Weights = std::initializer_list<double>>
  Value SampleOf(std::initializer_list<Value> values, const Weights& weights) {
    return values.begin()[index(weights, true)];
  }
  template <ListOfValues Values, class Weights = std::initializer_list<double>>
  decltype(auto) SampleDiscrete(Values&& values, const Weights& weights) {
    return element_of(std::forward<Values>(values), index(weights, true));
  }
  double SampleNormal(double mean, double sigma);
  double SampleUniform(double low, double high);
  void SetNull(bool& value) { value = false; }
  void Uninitialize(bool& value) { value = false; }
  void Initialize(bool& value) { value = true; }
  bool IsInitialized(bool value) { return value; }
  void report(NumberKey, const Distribution&) {}
  void end_world() {}

  int below(int count);

 private:
  int index(const auto& weights, bool scales) {
    const aos::List<double> copied(std::begin(weights), std::end(weights));
    return chosen(copied.data(), copied.size(), scales);
  }
  // Without `scales` the weights may leave a share in which no index is drawn.
  int chosen(const double* weights, std::size_t count, bool scales);
  double next(double otherwise);
  std::uint64_t bits();
  double uniform();

  const char* rest_ = nullptr;
  std::uint64_t state_ = 0;
};

// The members of the emitted `Model`, of states that are blocks of bytes.
struct ScriptedModel {
  std::size_t state_bytes;
  void (*prepare)();
  const std::vector<GroundedAction>* actions;
  std::span<const SkillFacts> skills;
  void (*initial)(void* state, ScriptedDraws& draws);
  Step (*step)(void* state, int action, ScriptedDraws& draws);
  Ending (*ending)(const void* state);
  bool (*meets_precondition)(const void* state, int action, ScriptedDraws& draws);
  aos::List<double> (*rollout_weights)(const void* state, ScriptedDraws& draws);  // of all actions
  double (*state_value)(const void* state, ScriptedDraws& draws);
  void (*visit)(const void* state, ValueVisitor& visitor);
  bool (*is_saved)(const void* state);  // it is the same after it was written and read
};

// The model that this executable is linked with.
extern const ScriptedModel scripted_model;

template <class Model>
constexpr ScriptedModel scripted_model_of() {
  using State = typename Model::State;
  static_assert(std::is_trivially_copyable_v<State> && alignof(State) <= alignof(std::max_align_t));
  return {
      .state_bytes = sizeof(State),
      .prepare = Model::prepare,
      .actions = &Model::grounded_actions(),
      .skills = Model::skills(),
      .initial = [](void* state, ScriptedDraws& draws) { Model::initial(state_at<State>(state), draws); },
      .step = [](void* state, int action,
                 ScriptedDraws& draws) { return Model::step(state_at<State>(state), action, draws); },
      .ending = [](const void* state) { return Model::ending(state_at<State>(state)); },
      .meets_precondition = [](const void* state, int action,
                               ScriptedDraws& draws) { return Model::meets_precondition(state_at<State>(state), action, draws); },
      .rollout_weights =
          [](const void* state, ScriptedDraws& draws) {
            aos::List<double> weights;
            Model::rollout_weights(state_at<State>(state), draws, [&](double weight) { weights.push_back(weight); });
            return weights;
          },
      .state_value = [](const void* state,
                        ScriptedDraws& draws) -> double { return Model::state_value(state_at<State>(state), draws); },
      .visit = [](const void* state, ValueVisitor& visitor) { visit_value(state_at<State>(state), visitor); },
      .is_saved =
          [](const void* state) {
            State loaded{};
            Model::load_state(loaded, Model::save_state(state_at<State>(state)), Model::save_constants());
            return loaded == state_at<State>(state) && Model::hash(loaded) == Model::hash(state_at<State>(state));
          },
  };
}

}
