// The compiled model in the form that the engine's templates expect, with states that are blocks of bytes: only the compiled model can
// read these. It calls the functions of the model table.
#pragma once

#include <optional>

#include "aos/base/set_for_now.hpp"
#include "aos/model/model_table.hpp"
#include "aos/model/values.hpp"
#include "aos/model/violations.hpp"

namespace aos {

// A state of up to `Size` bytes, in place.
template <std::size_t Size>
struct InPlaceState {
  alignas(std::uint64_t) std::byte bytes[Size]{};

  friend bool operator==(const InPlaceState& left, const InPlaceState& right) {
    return compiled_model.equal(left.bytes, right.bytes);
  }
};

// A state of any size, in memory of its own. An object that was moved from may only be assigned to.
class OwnedState {
 public:
  std::byte* bytes;

  OwnedState() : bytes(taken()) { std::memset(bytes, 0, size()); }
  OwnedState(const OwnedState& other) : bytes(taken()) { std::memcpy(bytes, other.bytes, size()); }
  OwnedState(OwnedState&& other) noexcept : bytes(std::exchange(other.bytes, nullptr)) {}
  OwnedState& operator=(const OwnedState& other) {
    if (bytes == nullptr) bytes = taken();
    if (bytes != other.bytes) std::memcpy(bytes, other.bytes, size());
    return *this;
  }
  OwnedState& operator=(OwnedState&& other) noexcept {
    std::swap(bytes, other.bytes);
    return *this;
  }
  ~OwnedState() { std::free(bytes); }

  friend bool operator==(const OwnedState& left, const OwnedState& right) {
    return compiled_model.equal(left.bytes, right.bytes);
  }

 private:
  static std::size_t size() { return compiled_model.state_bytes; }
  static std::byte* taken() {
    auto* const block = static_cast<std::byte*>(std::malloc(size()));
    if (block == nullptr) throw std::bad_alloc{};
    return block;
  }
};

// A `Size` of 0 stands for any size.
template <std::size_t Size>
using ErasedState = std::conditional_t<Size == 0, OwnedState, InPlaceState<Size == 0 ? 1 : Size>>;

// States have up to `Size` bytes; a `Size` of 0 stands for any size.
template <std::size_t Size>
struct ErasedModel {
  using State = ErasedState<Size>;
  inline static const char* const project = compiled_model.project;
  inline static const int horizon = compiled_model.horizon;
  inline static const double discount = compiled_model.discount;
  inline static const int skill_count = static_cast<int>(compiled_model.skills.size());
  inline static const bool has_rollout_policy = compiled_model.has_rollout_policy;
  inline static const bool has_state_heuristic = compiled_model.has_state_heuristic;
  inline static const bool has_goal_conditions = compiled_model.has_goal_conditions;

  static void prepare() { compiled_model.prepare(); }
  // The constants that the mission sets; they have their values when all is prepared.
  static std::span<const Member> mission_parameters() { return compiled_model.mission_parameters; }
  static int action_count() { return static_cast<int>(compiled_model.actions->size()); }
  static int monitor_count() { return static_cast<int>(compiled_model.monitors->size()); }
  static const char* action_name(int action) { return grounded(action).words->name.c_str(); }
  // The parameters of an action with the texts of their values.
  static const auto& arguments_of(int action) { return grounded(action).words->arguments; }
  static int skill_of(int action) { return grounded(action).skill; }
  static const char* skill_name(int skill) { return compiled_model.skills[skill].name; }
  static int response_count(int skill) { return compiled_model.skills[skill].response_count; }
  static const char* response_name(int skill, int response) { return compiled_model.skills[skill].responses[response]; }
  static bool has_text_response(int skill) { return compiled_model.skills[skill].has_text_response; }
  // Whether all grounded actions of the skill lead to the same states with the same rewards.
  static bool has_alike_groundings(int skill) { return compiled_model.skills[skill].has_alike_groundings; }
  // Whether the reward follows from the state and the grounded action.
  static bool has_certain_rewards(int skill) { return compiled_model.skills[skill].has_certain_rewards; }
  // How many numbers and arrays of numbers a step of the skill may report besides its response.
  static int number_count(int skill) { return compiled_model.skills[skill].number_count; }
  static bool reports_numbers() {
    return std::ranges::any_of(compiled_model.skills, [](const SkillFacts& skill) { return skill.number_count > 0; });
  }
  static void write_parameters(int action, JsonWriter& json) {
    compiled_model.skills[skill_of(action)].write_parameters(grounded(action).parameters, json);
  }
  static void read_locals(int action, std::string_view text) {
    compiled_model.skills[skill_of(action)].read_locals(text);
  }

  static Ending ending(const State& state) { return static_cast<Ending>(state.bytes[compiled_model.ending_offset]); }
  static std::uint64_t hash(const State& state) { return compiled_model.hash(state.bytes); }
  static std::string state_text(const State& state) { return compiled_model.state_text(state.bytes); }
  static std::string save_state(const State& state) { return compiled_model.save_state(state.bytes); }
  static SavedConstants save_constants() { return compiled_model.save_constants(); }
  static void load_state(State& state, std::string_view saved, const SavedConstants& constants) {
    compiled_model.load_state(state.bytes, saved, constants);
  }
  static void visit_values(const State& state, ValueVisitor& visitor) { compiled_model.visit(state.bytes, visitor); }
  // All variables that a saved state holds; the special states that count once and are spent, a bit for each.
  static std::span<const Member> variables() { return compiled_model.variables; }
  static std::uint64_t spent(const State& state) { return compiled_model.spent(state.bytes); }
  static void set_end(State& state, Ending ending, std::uint64_t spent) {
    compiled_model.set_end(state.bytes, ending, spent);
  }
  // The parts of a state that no reward, observation or ending depends on.
  static std::span<const ByteRange> irrelevant() { return compiled_model.irrelevant; }
  // How many bytes of a state the model uses; the others are 0.
  static std::size_t state_bytes() { return compiled_model.state_bytes; }
  static const std::byte* bytes_of(const State& state) { return state.bytes; }
  static std::byte* bytes_of(State& state) { return state.bytes; }
  // How many bytes a state takes outside of its object.
  static std::size_t bytes_elsewhere() { return Size == 0 ? state_bytes() : 0; }

  template <class Random>
  static void initial(State& state, Random& random) { functions(random).initial(state.bytes, random); }
  // Makes a state one in which a mission begins, after so many steps of extrinsic changes alone. Whether an earlier mission
  // has ended there, makes no difference.
  static void begin(State& state, int idle_steps, DirectedDraws& random) {
    for (int step = 0; step < idle_steps; ++step) {
      compiled_model.set_end(state.bytes, Ending::running, 0);
      compiled_model.pass(state.bytes, random);
    }
    compiled_model.begin(state.bytes, random);
  }
  template <class Random>
  static Step step(State& state, int action, Random& random) {
    if constexpr (!std::is_same_v<Random, Sampler>) {
      if (corrected_) return corrected_step(state, action, random);
      if (action == no_action) {
        compiled_model.pass(state.bytes, random);
        return {};
      }
    }
    return functions(random).step(state.bytes, action, random);
  }
  // As long as this object lives, directed steps are corrected where they give this observation. Belief updates use it.
  struct Correcting : SetForNow<std::optional<Observation>> {
    explicit Correcting(Observation made) : SetForNow(corrected_, made) {}
  };
  // As long as this object lives, the model has only the actions that are not left out: their numbers are then those in
  // the shorter list. Searches use it, one at a time.
  class Without {
   public:
    // `left_out` says of each action whether it is.
    explicit Without(const std::vector<bool>& left_out) : all_(actions()) {
      std::size_t number = 0;
      std::erase_if(actions(), [&](const GroundedAction&) { return left_out[number++]; });
    }
    Without(const Without&) = delete;
    Without& operator=(const Without&) = delete;
    ~Without() { actions() = std::move(all_); }

   private:
    // The table shows a vector that is not const itself.
    static std::vector<GroundedAction>& actions() { return const_cast<std::vector<GroundedAction>&>(*compiled_model.actions); }
    std::vector<GroundedAction> all_;
  };
  static bool meets_precondition(const State& state, int action, DirectedDraws& random) {
    return compiled_model.meets_precondition(state.bytes, action, random);
  }
  // How many of the conditions hold that rewards and goals have; 0 where none of them has several.
  static int conditions_met(const State& state) { return compiled_model.conditions_met(state.bytes); }
  // The mission's constraints: their number, whether one of them reads the next state, and which ones a step violates.
  static int constraint_count() { return compiled_model.constraint_count; }
  static bool constraints_look_ahead() { return compiled_model.constraints_look_ahead; }
  static Violations violations(const State& before, const State& next, int action) {
    return compiled_model.violations(before.bytes, next.bytes, action);
  }
  // The discounted return of one rollout: see rollout.hpp.
  static double rollout(const State& state, int& left, Sampler& random) {
    return compiled_model.rollout(state.bytes, left, random);
  }
  // Writes to `odds` the probability with which a rollout takes each action first.
  static void rollout_odds(const State& state, double* odds, Sampler& random) {
    compiled_model.rollout_odds(state.bytes, odds, action_count(), random);
  }

 private:
  static const GroundedAction& grounded(int action) {
    if (is_monitor(action)) return (*compiled_model.monitors)[action - first_monitor];
    return (*compiled_model.actions)[action];
  }

  static Step corrected_step(State& state, int action, DirectedDraws& random) {
    const State before = state;
    const Step step = compiled_model.directed.step(state.bytes, action, random);
    if (step.observation == *corrected_) compiled_model.correct(before.bytes, state.bytes, action, random);
    return step;
  }

  inline static std::optional<Observation> corrected_;

  static const auto& functions(const Sampler&) { return compiled_model.sampling; }
  static const auto& functions(const DirectedDraws&) { return compiled_model.directed; }
};

}
