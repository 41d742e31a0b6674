// One simulated step in the phases of the documents: which phase reads and changes which copy of the state.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/base/reward_ledger.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/grounding.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/step.hpp"

namespace aos {

class Sampler;

inline constexpr const char* no_text_response = "NoStrResponse";

// What the dynamic model of a skill gives besides the next state. Responses count from 1, so that each is
// true where a document uses it as a condition. 0 is the default observation.
struct Effect {
  double reward = 0;
  int response = 0;
};

struct EffectWithText : Effect {
  std::string text = no_text_response;
};

// Shows the text of a response, while it is written, to the code that directs the draws.
class ShownText {
 public:
  explicit ShownText(const EffectWithText& effect) { response_text = &effect.text; }
  ShownText(const ShownText&) = delete;
  ShownText& operator=(const ShownText&) = delete;
  ~ShownText() {
    if (finished_text != nullptr) *finished_text = *response_text;
    response_text = nullptr;
  }
};
struct NoText {
  explicit NoText(const Effect&) {}
};

// The defaults for what a skill document leaves out.
struct SkillDefaults {
  struct aos_Parameters {
    static void aos_fields(auto&, auto&&) {}
  };
  static constexpr double violation_penalty = 0;
  static constexpr bool has_text_response = false;
  static constexpr bool is_monitor = false;
  static constexpr int number_count = 0;
  // Whether the parameters shape only what is observed (lowering/relevance.py).
  static constexpr bool has_alike_groundings = false;
  // Whether the draws shape only what is observed.
  static constexpr bool has_certain_rewards = false;
  // Whether a step reads `state` (or `state_`) after it has changed a later copy of the state.
  static constexpr bool keeps_state = false;
  static constexpr bool keeps_state_ = false;
  static void make_groundings(const auto&, Groundings groundings) {
    static constexpr aos_Parameters none{};
    groundings.add({}, &none);
  }
  static void precondition(const auto&, bool&, const auto&, auto&) {}
  static void execution_time(const auto&, int&, const auto&, auto&) {}
  static void next_state(auto&, auto&, auto&, bool, int, auto&, const auto&, auto&) {}
  static void rollout_policy(const auto&, double&, const auto&, auto&) {}
  // Whether it counts the conditions of its rewards (goal_conditions.hpp).
  static constexpr bool has_goal_conditions = false;
  // The local variables of the abstraction mapping at the time of the response.
  struct aos_Locals {};
  static void given_observation(const auto&, auto&, const auto&, const auto&, auto&) {}
};

// How the phases of a step are run: each comes to an end. For other models see endless_steps.hpp.
struct EndingSteps {
  static Step run(auto& next, const auto& /*parameters*/, auto& random, double /*penalty*/, auto&& phases) {
    bool meets_precondition = true;
    return phases(next, random, meets_precondition);
  }
};

// The defaults for what an environment document leaves out.
struct EnvironmentDefaults {
  using Steps = EndingSteps;
  static constexpr bool is_one_state = false;
  static constexpr bool has_extrinsic_changes = false;
  static constexpr bool has_special_states = false;
  static constexpr bool has_goal_conditions = false;
  static void initial_belief(auto&, auto&) {}
  static void extrinsic_changes(auto&, auto&, double&, int, const auto&, auto&) {}
  static double special_states(auto&, auto&) { return 0; }
  static void state_heuristic(const auto&, double&, auto&) {}
  static std::string state_text(const auto& state) { return leaves_text(state); }
};

// The skill of a step in which nothing is done.
template <class Environment>
struct NoSkill : SkillDefaults {
  static constexpr std::array<const char*, 0> response_names{};
  static constexpr bool keeps_state = !Environment::is_one_state;
};

namespace detail {

// Where a study has a ledger, it is told the reward of each phase, and the place that runs. Samplers have none.
inline void note_reward(double reward) {
  if (reward_ledger != nullptr) [[unlikely]] reward_ledger->end_phase(blame::piece(), reward);
}
template <class Random>
inline constexpr bool notes_rewards = !std::is_same_v<std::remove_cvref_t<Random>, Sampler>;

}  // namespace detail

// What a special state says: only that the mission ends, or also whether this is a failure.
enum class Said { endings, failures };

// If failures are not said, the sign of the reward decides.
template <Said said>
Ending ending_of(double reward, bool is_failure) {
  if constexpr (said == Said::failures) {
    return is_failure ? Ending::failure : Ending::goal;
  } else {
    return reward > 0 ? Ending::goal : reward < 0 ? Ending::failure : Ending::over;
  }
}

// Evaluates a special state on the next state and returns its reward; it is 0 if `bit` is already spent. The
// first ending decides how the state ends. `evaluate` sets four results: the reward, whether the mission
// ends, whether it ends as a failure, and whether the special state is spent from now on.
template <Said said = Said::endings, class State>
double special_state(State& next, std::uint64_t bit, auto&& evaluate) {
  if constexpr (requires { next.aos_spent; }) {
    if ((next.aos_spent & bit) != 0) return 0;
  }
  double reward = 0;
  bool is_goal = false;
  bool is_failure = false;
  bool is_used_up = false;
  evaluate(reward, is_goal, is_failure, is_used_up);
  detail::note_reward(reward);
  if ((is_goal || is_failure) && next.aos_ending == Ending::running) next.aos_ending = ending_of<said>(reward, is_failure);
  if constexpr (requires { next.aos_spent; }) {
    if (is_used_up) next.aos_spent |= static_cast<decltype(next.aos_spent)>(bit);
  }
  return reward;
}

namespace detail {

// These throw a ModelFault. They are kept out of the code that runs in every step.
[[noreturn, gnu::cold]] void no_such_response(int response);
[[noreturn, gnu::cold]] void no_such_reward(double reward);
// A text that is no UTF-8 is a ModelFault.
void check_letters(std::string_view text);
// Called after each phase that has a reward, so that this phase is blamed and not the one after it.
inline void check_reward(double reward) {
  if (!is_reward(reward)) no_such_reward(reward);
}

template <class Skill>
Observation observation_of(const auto& effect) {
  if constexpr (Skill::has_text_response) {
    if (effect.text != no_text_response) {
      check_letters(effect.text);
      return text_observation(effect.text);
    }
  }
  constexpr int last = static_cast<int>(Skill::response_names.size());
  if (effect.response < 0 || effect.response > last) no_such_response(effect.response);
  return effect.response - 1;
}

// A copy of a state if it is kept, else another name for the state.
template <class State, bool is_kept>
using Kept = std::conditional_t<is_kept, const State, State&>;

// The phases of a step after the extrinsic changes.
template <class Environment, class Skill>
Step run_skill(auto& state, auto& state_, auto& next, bool meets_precondition, int execution_time,
               double extrinsic_reward, const auto& parameters, auto& random) {
  std::conditional_t<Skill::has_text_response, EffectWithText, Effect> effect;
  [[maybe_unused]] const std::conditional_t<Skill::has_text_response, ShownText, NoText> shown{effect};
  Skill::next_state(state, state_, next, meets_precondition, execution_time, effect, parameters, random);
  if constexpr (notes_rewards<decltype(random)>) note_reward(effect.reward);
  Step step;
  step.reward = effect.reward;
  // Adding zero takes time as well, so only terms that may differ from zero are added.
  const double penalty = meets_precondition ? 0 : Skill::violation_penalty;
  if constexpr (Skill::violation_penalty != 0 && notes_rewards<decltype(random)>) {
    if (reward_ledger != nullptr) [[unlikely]] reward_ledger->end_phase(0, penalty, Skill::aos_name);
  }
  if constexpr (Environment::has_extrinsic_changes) {
    step.reward = penalty + extrinsic_reward + effect.reward;
  } else if constexpr (Skill::violation_penalty != 0) {
    step.reward = penalty + effect.reward;
  }
  check_reward(step.reward);
  step.observation = observation_of<Skill>(effect);
  if constexpr (Environment::has_special_states) {
    step.reward += Environment::special_states(next, random);
    check_reward(step.reward);
  }
  return step;
}

// Runs the phases in their order. They change the state in place, and what a later phase reads is copied
// before. The copies never change, so a compiler copies only what is read.
template <class Environment, class Skill, class State>
Step run_phases(State& next, const auto& parameters, auto& random, bool& meets_precondition) {
  Kept<State, Skill::keeps_state> state = next;
  Skill::precondition(state, meets_precondition, parameters, random);
  int execution_time = -1;
  Skill::execution_time(state, execution_time, parameters, random);

  if constexpr (Environment::has_extrinsic_changes) {
    double reward = 0;
    const typename Environment::aos_Chosen chosen{std::type_identity<Skill>{}, parameters};
    Environment::extrinsic_changes(state, next, reward, execution_time, chosen, random);
    if constexpr (notes_rewards<decltype(random)>) note_reward(reward);
    check_reward(reward);
    random.end_world();
    Kept<State, Skill::keeps_state_> state_ = next;
    return run_skill<Environment, Skill>(state, state_, next, meets_precondition, execution_time, reward, parameters,
                                         random);
  } else {
    random.end_world();
    return run_skill<Environment, Skill>(state, state, next, meets_precondition, execution_time, 0, parameters, random);
  }
}

template <class Environment, class Skill, class State>
Step transition(State& next, const auto& parameters, auto& random) {
  return Environment::Steps::run(next, parameters, random, Skill::violation_penalty, [&](State& state, auto& draws, bool& meets_precondition) {
    return run_phases<Environment, Skill>(state, parameters, draws, meets_precondition);
  });
}

// The observation in an ended state: what the documents give there, or the default observation if they raise
// a ModelFault.
template <class Environment, class Skill, class State>
[[gnu::cold, gnu::noinline]] Step step_after_the_end(State copy, const auto& parameters, auto& random) {
  copy.aos_ending = Ending::running;
  try {
    const Observation observation = transition<Environment, Skill>(copy, parameters, random).observation;
    return {0, observation == no_observation ? default_observation : observation};
  } catch (const ModelFault&) {
    return {};
  }
}

}  // namespace detail

// The response of a monitor to a state, which stays as it is. In an ended state a ModelFault is the default observation.
template <class Monitor, class State>
Step look(const State& state, auto& random) {
  Effect effect;
  try {
    Monitor::respond(state, effect, random);
    return {0, detail::observation_of<Monitor>(effect)};
  } catch (const ModelFault&) {
    if (state.aos_ending == Ending::running) throw;
    return {};
  }
}

// Runs a skill in place, or asks a monitor. An ended state stays as it is and gives no reward.
template <class Environment, class Skill, class State>
Step step(State& state, const auto& parameters, auto& random) {
  if constexpr (Skill::is_monitor) {
    return look<Skill>(state, random);
  } else {
    if (state.aos_ending != Ending::running) [[unlikely]] {
      return detail::step_after_the_end<Environment, Skill>(state, parameters, random);
    }
    return detail::transition<Environment, Skill>(state, parameters, random);
  }
}

// Lets the time of a step pass: the extrinsic changes, and the special states that they lead to.
template <class Environment, class State>
void pass(State& state, auto& random) {
  if constexpr (Environment::has_extrinsic_changes) {
    if (state.aos_ending != Ending::running) return;
    detail::transition<Environment, NoSkill<Environment>>(state, SkillDefaults::aos_Parameters{}, random);
  }
}

template <class Skill>
bool meets_precondition(const auto& state, const auto& parameters, auto& random) {
  bool meets = true;
  Skill::precondition(state, meets, parameters, random);
  return meets;
}

// The weight that the rollout policy gives the action; never negative.
template <class Skill>
double rollout_weight(const auto& state, const auto& parameters, auto& random) {
  double weight = 0;
  Skill::rollout_policy(state, weight, parameters, random);
  return weight > 0 ? weight : 0;
}

}  // namespace aos
