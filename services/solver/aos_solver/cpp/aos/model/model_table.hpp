// A compiled model as a table of functions over states, which are blocks of bytes. The engine is compiled
// once for all models with states of about the same size, and a model is compiled without the engine.
#pragma once

#include "aos/draws/directed.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/build_kind.hpp"
#include "aos/model/grounding.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/rollout.hpp"
#include "aos/model/state_text.hpp"
#include "aos/model/violations.hpp"

namespace aos {

// The functions of a model that draw, for one kind of source.
template <class Random>
struct DrawingFunctions {
  void (*initial)(void* state, Random& random);
  Step (*step)(void* state, int action, Random& random);
};

// The size of a state as text. The build finds this text in the object file and links the engine for such states.
template <std::size_t Size>
inline constexpr auto size_mark = [] {
  std::array<char, 32> mark{"aos-state-bytes:0000000000;"};
  for (std::size_t place = 25, rest = Size; rest > 0; rest /= 10) mark[place--] = static_cast<char>('0' + rest % 10);
  return mark;
}();

// See `ModelOf` for what each member means.
struct ModelTable {
  const char* size_mark;
  std::size_t state_bytes;
  const char* project;
  int horizon;
  double discount;
  std::span<const SkillFacts> skills;
  const std::vector<GroundedAction>* actions;
  const std::vector<GroundedAction>* monitors;
  bool has_rollout_policy;
  bool has_state_heuristic;
  bool has_goal_conditions;
  std::size_t ending_offset;
  std::span<const ByteRange> irrelevant;  // parts of a state
  std::span<const Member> variables;      // that a saved state holds
  int constraint_count;
  bool constraints_look_ahead;
  std::span<const Member> mission_parameters;

  void (*prepare)();
  bool (*equal)(const void* left, const void* right);
  std::uint64_t (*hash)(const void* state);
  void (*visit)(const void* state, ValueVisitor& visitor);
  std::string (*state_text)(const void* state);
  std::string (*save_state)(const void* state);
  SavedConstants (*save_constants)();
  void (*load_state)(void* state, std::string_view saved, const SavedConstants& constants);

  std::uint64_t (*spent)(const void* state);
  void (*set_end)(void* state, Ending ending, std::uint64_t spent);

  DrawingFunctions<Sampler> sampling;
  DrawingFunctions<DirectedDraws> directed;
  void (*pass)(void* state, DirectedDraws& random);
  void (*begin)(void* state, DirectedDraws& random);
  void (*correct)(const void* before, void* next, int action, DirectedDraws& random);
  bool (*meets_precondition)(const void* state, int action, DirectedDraws& random);
  int (*conditions_met)(const void* state);
  Violations (*violations)(const void* before, const void* next, int action);
  double (*rollout)(const void* state, int& left, Sampler& random);
  void (*rollout_odds)(const void* state, double* odds, int count, Sampler& random);
};

// The model that this executable is linked with.
extern const ModelTable compiled_model;

// The state behind a pointer.
template <class State>
State& state_at(void* state) { return *static_cast<State*>(state); }
template <class State>
const State& state_at(const void* state) { return *static_cast<const State*>(state); }

template <class Model, class Random>
constexpr DrawingFunctions<Random> drawing_functions() {
  using State = typename Model::State;
  return {
      .initial = [](void* state, Random& random) {
        ModelSource<Random> draws{random};
        Model::initial(state_at<State>(state), draws);
        blame::over();
      },
      .step = [](void* state, int action, Random& random) {
        ModelSource<Random> draws{random};
        const Step step = Model::step(state_at<State>(state), action, draws);
        blame::over();
        return step;
      },
  };
}

template <class Model>
constexpr ModelTable table_of() {
  using State = typename Model::State;
  static_assert(std::is_trivially_copyable_v<State> && alignof(State) <= alignof(std::uint64_t));
  return {
      .size_mark = size_mark<sizeof(State)>.data(),
      .state_bytes = sizeof(State),
      .project = Model::project,
      .horizon = Model::horizon,
      .discount = Model::discount,
      .skills = Model::skills(),
      .actions = &Model::grounded_actions(),
      .monitors = &Model::monitors(),
      .has_rollout_policy = Model::has_rollout_policy,
      .has_state_heuristic = Model::has_state_heuristic,
      .has_goal_conditions = Model::has_goal_conditions,
      .ending_offset = offsetof(State, aos_ending),
      .irrelevant = Model::irrelevant,
      .variables = Model::variables,
      .constraint_count = Model::constraint_count,
      .constraints_look_ahead = Model::constraints_look_ahead,
      .mission_parameters = Model::mission_parameters,
      .prepare = Model::prepare,
      .equal = [](const void* left, const void* right) { return state_at<State>(left) == state_at<State>(right); },
      .hash = [](const void* state) { return Model::hash(state_at<State>(state)); },
      .visit = [](const void* state, ValueVisitor& visitor) { visit_value(state_at<State>(state), visitor); },
      .state_text = [](const void* state) { return Model::state_text(state_at<State>(state)); },
      .save_state = [](const void* state) { return Model::save_state(state_at<State>(state)); },
      .save_constants = Model::save_constants,
      .load_state = [](void* state, std::string_view saved, const SavedConstants& constants) { Model::load_state(state_at<State>(state), saved, constants); },
      .spent = [](const void* state) { return Model::spent(state_at<State>(state)); },
      .set_end = [](void* state, Ending ending, std::uint64_t spent) { Model::set_end(state_at<State>(state), ending, spent); },
      .sampling = drawing_functions<Model, Sampler>(),
      .directed = drawing_functions<Model, DirectedDraws>(),
      .pass = [](void* state, DirectedDraws& random) {
        ModelSource<DirectedDraws> draws{random};
        Model::pass(state_at<State>(state), draws);
        blame::over();
      },
      .begin = [](void* state, DirectedDraws& random) {
        ModelSource<DirectedDraws> draws{random};
        Model::begin(state_at<State>(state), draws);
        blame::over();
      },
      .correct = [](const void* before, void* next, int action, DirectedDraws& random) {
        if constexpr (Model::has_corrections) {
          ModelSource<DirectedDraws> draws{random};
          Model::correct(state_at<State>(before), state_at<State>(next), action, draws);
        }
      },
      .meets_precondition = [](const void* state, int action, DirectedDraws& random) {
        ModelSource<DirectedDraws> draws{random};
        const bool meets = Model::meets_precondition(state_at<State>(state), action, draws);
        blame::over();
        return meets;
      },
      .conditions_met = [](const void* state) -> int {
        if constexpr (Model::has_goal_conditions) {
          Sampler same{1};
          ModelSource<Sampler> draws{same};
          const int met = Model::conditions_met(state_at<State>(state), draws);
          blame::over();
          return met;
        }
        return 0;
      },
      .violations = [](const void* before, const void* next, int action) -> Violations {
        if constexpr (Model::constraint_count > 0) {
          return Model::violations(state_at<State>(before), state_at<State>(next), action);
        }
        return 0;
      },
      .rollout = [](const void* state, int& left, Sampler& random) {
        const double value = aos::rollout<Model>(state_at<State>(state), left, random);
        blame::over();
        return value;
      },
      .rollout_odds = [](const void* state, double* odds, int count, Sampler& random) {
        aos::rollout_odds<Model>(state_at<State>(state), odds, count, random);
        blame::over();
      },
  };
}

}
