// A compiled model, made of what an emitted file says of its project. Everything that is the same for all projects is here.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/base/mixed.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/correction.hpp"
#include "aos/model/goal_conditions.hpp"
#include "aos/model/grounding.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/state_text.hpp"
#include "aos/model/transition.hpp"
#include "aos/model/violations.hpp"

namespace aos {

template <class Skill>
struct LocalsOf {
  typename Skill::aos_Locals values{};
};

// The skills of a project, in the order of their numbers.
template <class... Skills>
struct SkillList {
  template <class Model>
  static constexpr std::array<SkillFacts, sizeof...(Skills)> facts{facts_of<Skills>(Model::template read_locals<Skills>)...};
  static constexpr bool has_monitors = (Skills::is_monitor || ...);
  static constexpr bool have_goal_conditions = (Skills::has_goal_conditions || ...);
  // The local variables of the last real observation of each skill.
  struct aos_Locals : LocalsOf<Skills>... {};
};

// Calls `use` with the type of the skill of this number, which is not below `first`.
template <std::size_t first = 0, class... Skills>
decltype(auto) with_skill(SkillList<Skills...> skills, int skill, auto&& use) {
  using Types = std::tuple<std::type_identity<Skills>...>;
  constexpr std::size_t last = sizeof...(Skills) - 1;
  switch (skill - static_cast<int>(first)) {
#define AOS_SKILL(n) \
  case n: \
    if constexpr (first + n < last) return use(std::tuple_element_t<first + n, Types>{}); \
    [[fallthrough]];
    AOS_SKILL(0) AOS_SKILL(1) AOS_SKILL(2) AOS_SKILL(3) AOS_SKILL(4) AOS_SKILL(5) AOS_SKILL(6) AOS_SKILL(7)
    AOS_SKILL(8) AOS_SKILL(9) AOS_SKILL(10) AOS_SKILL(11) AOS_SKILL(12) AOS_SKILL(13) AOS_SKILL(14) AOS_SKILL(15)
#undef AOS_SKILL
    default:
      if constexpr (first + 16 <= last) {
        return with_skill<first + 16>(skills, skill, use);
      } else {
        return use(std::tuple_element_t<last, Types>{});
      }
  }
}

// The defaults for what a project does not have. A project also gives `State`, `Draft`, `Environment`, `Skills`, `name`,
// `horizon`, `discount`, `default_values` and `variables`: all variables that a saved state holds.
struct ProjectDefaults {
  // Whether the default values are drawn anew for each state.
  static constexpr bool draws_defaults = false;
  static constexpr bool has_rollout_policy = false;
  static constexpr bool has_state_heuristic = false;
  static constexpr bool has_corrections = false;
  // The variables on which no reward, observation or ending depends.
  static constexpr std::array<ByteRange, 0> irrelevant{};
  // The mission's constraints, whether one of them reads the next state, and whether violating one costs.
  static constexpr int constraint_count = 0;
  static constexpr bool constraints_look_ahead = false;
  static constexpr bool has_costs = false;
  static constexpr std::span<const Member> mission_parameters{};
  // Keeps the variables that no state holds.
  static void set_constants(const auto&) {}
};

template <class Project>
class ModelOf {
  using Environment = typename Project::Environment;
  using Draft = typename Project::Draft;
  using Skills = typename Project::Skills;

 public:
  using State = typename Project::State;
  static constexpr const char* project = Project::name;
  static constexpr int horizon = Project::horizon;
  static constexpr double discount = Project::discount;
  static constexpr std::span<const SkillFacts> skills() { return Skills::template facts<ModelOf>; }
  static constexpr std::span<const ByteRange> irrelevant{Project::irrelevant};
  static constexpr bool has_rollout_policy = Project::has_rollout_policy;
  static constexpr bool has_state_heuristic = Project::has_state_heuristic;
  static constexpr bool has_corrections = Project::has_corrections;
  static constexpr int constraint_count = Project::constraint_count;
  static constexpr bool constraints_look_ahead = Project::constraints_look_ahead;
  static constexpr std::span<const Member> mission_parameters{Project::mission_parameters};

  // Sets the constants and grounds the actions. It is called once, before anything else.
  static void prepare() {
    Draft draft;
    FixedDraws draws;
    set_default_values(draft, draws);
    Project::set_constants(draft);
    prepared_.start = draft;
    prepared_.grounded.clear();
    prepared_.monitors.clear();
    ground(Skills{}, draft);
    if (prepared_.grounded.actions.empty()) {
      throw ModelFault{"AOS119", "no skill has a grounded action: lists are made once, from the variables' defaults"};
    }
    blame::at(0);
  }

  static int action_count() { return static_cast<int>(prepared_.grounded.actions.size()); }
  static constexpr const std::vector<GroundedAction>& grounded_actions() { return prepared_.grounded.actions; }
  static constexpr const std::vector<GroundedAction>& monitors() { return prepared_.monitors.actions; }

  static void initial(State& state, auto& random) {
    if constexpr (Project::draws_defaults) {
      Draft draft;
      set_default_values(draft, random);
      state = draft;
    } else {
      state = prepared_.start;
    }
    Environment::initial_belief(state, random);
    Environment::special_states(state, random);
    blame::at(0);
  }
  // Whether some reward or goal has several conditions, and how many of them hold. A skill's are those of the parameters with which
  // most hold.
  static constexpr bool has_goal_conditions = Environment::has_goal_conditions || Skills::have_goal_conditions;
  static int conditions_met(const State& state, auto& random) {
    int met = 0;
    if constexpr (Environment::has_goal_conditions) met += special_conditions_met<Environment>(state, random);
    if constexpr (Skills::have_goal_conditions) {
      const char* skill = "";
      int most = 0;
      with_each_grounding(Skills{}, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
        if constexpr (Skill::has_goal_conditions) {
          if (skill != Skill::aos_name) met += std::exchange(most, 0);
          skill = Skill::aos_name;
          most = std::max(most, skill_conditions_met<Skill>(state, parameters, random));
        }
      });
      met += most;
    }
    blame::at(0);
    return met;
  }
  static Step step(State& state, int action, auto& random) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      // Two conditions, one in the other: Clang looks up what a project without costs does not have in the first.
      if constexpr (Project::has_costs) {
        if constexpr (!Skill::is_monitor) {
          const State before = state;
          Step step = aos::step<Environment, Skill>(state, parameters, random);
          if (before.aos_ending == Ending::running) {
            step.reward -= Project::cost_of(Project::template violations<Skill>(before, state, parameters));
          }
          return step;
        }
      }
      return aos::step<Environment, Skill>(state, parameters, random);
    });
  }
  static void pass(State& state, auto& random) {
    aos::pass<Environment>(state, random);
    blame::at(0);
  }
  // Makes a state one in which a mission begins: nothing has ended or counted before, as in `initial`.
  static void begin(State& state, auto& random) {
    state.aos_ending = Ending::running;
    if constexpr (requires { state.aos_spent; }) state.aos_spent = {};
    Environment::special_states(state, random);
    blame::at(0);
  }
  static Violations violations(const State& before, const State& next, int action) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      return Project::template violations<Skill>(before, next, parameters);
    });
  }
  static bool meets_precondition(const State& state, int action, auto& random) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      return aos::meets_precondition<Skill>(state, parameters, random);
    });
  }
  // Calls `take` with the weight that the rollout policy gives each action, in the order of the actions.
  static void rollout_weights(const State& state, auto& random, auto&& take) {
    with_each_grounding(Skills{}, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      take(aos::rollout_weight<Skill>(state, parameters, random));
    });
  }
  static void correct(const State& before, State& next, int action, auto& random) {
    with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      aos::correct<Environment, Skill>(before, next, parameters, locals_of<Skill>(), random);
    });
  }
  template <class Skill>
  static void read_locals(std::string_view values) {
    if constexpr (!std::is_empty_v<typename Skill::aos_Locals>) aos::read_locals(locals_of<Skill>(), values);
  }
  static double state_value(const State& state, auto& random) {
    double value = 0;
    Environment::state_heuristic(state, value, random);
    blame::at(0);
    return value;
  }

  static Ending ending(const State& state) { return state.aos_ending; }
  static std::string state_text(const State& state) {
    const std::string text = Environment::state_text(state);
    blame::at(0);
    return text;
  }
  static std::uint64_t hash(const State& state) {
    auto ended = static_cast<std::uint64_t>(state.aos_ending);
    if constexpr (requires { state.aos_spent; }) ended ^= state.aos_spent << 2;
    return mixed(hashed(0, state), ended);
  }
  // All variables that a saved state holds; and the special states that count once and are spent, a bit for each.
  static constexpr std::span<const Member> variables{Project::variables};
  static std::uint64_t spent(const State& state) {
    if constexpr (requires { state.aos_spent; }) return state.aos_spent;
    return 0;
  }
  static void set_end(State& state, Ending ending, [[maybe_unused]] std::uint64_t spent) {
    state.aos_ending = ending;
    if constexpr (requires { state.aos_spent; }) state.aos_spent = static_cast<decltype(state.aos_spent)>(spent);
  }
  // The variables that differ between states, as text.
  static std::string save_state(const State& state) {
    StateWriter text;
    text.write(state);
    text.write(state.aos_ending);
    if constexpr (requires { state.aos_spent; }) text.write(state.aos_spent);
    return text.text();
  }
  // The variables that are the same in all states, as text.
  static SavedConstants save_constants() {
    SavedConstants saved;
    saved.add_all(Project::variables);
    return saved;
  }
  // Both texts may come from documents in which other variables were constants.
  static void load_state(State& state, std::string_view saved, const SavedConstants& constants) {
    StateReader text{saved};
    constants.read_all(Project::variables, &state, text);
    text.read(state.aos_ending);
    if constexpr (requires { state.aos_spent; }) text.read(state.aos_spent);
    text.finish();
  }

 private:
  // The state before the initial belief, the actions, and what real observations give.
  struct Prepared {
    State start;
    GroundedActions grounded;
    GroundedActions monitors;
    typename Skills::aos_Locals locals;
  };
  inline static Prepared prepared_;

  template <class Skill>
  static typename Skill::aos_Locals& locals_of() { return static_cast<LocalsOf<Skill>&>(prepared_.locals).values; }

  static void set_default_values(Draft& draft, auto& random) {
    if constexpr (Project::draws_defaults) {
      Project::default_values(draft, random);
    } else {
      Project::default_values(draft);
    }
    blame::at(0);
  }

  template <class... Listed>
  static void ground(SkillList<Listed...>, const Draft& draft) {
    int number = 0;
    (Listed::make_groundings(
         draft, Groundings{Listed::is_monitor ? prepared_.monitors : prepared_.grounded, number++, Listed::aos_name}),
     ...);
  }

  static const GroundedAction& grounded(int action) {
    if constexpr (Skills::has_monitors) {
      if (is_monitor(action)) return prepared_.monitors.actions[action - first_monitor];
    }
    return prepared_.grounded.actions[action];
  }

  static decltype(auto) with_action(int action, auto&& use) {
    const GroundedAction& chosen = grounded(action);
    return with_skill(Skills{}, chosen.skill, [&]<class Skill>(std::type_identity<Skill> skill) -> decltype(auto) {
      return use(skill, parameters_of<Skill>(chosen));
    });
  }

  // Calls `use` with a skill's type and the parameters of each of its groundings, skill by skill.
  template <class... Listed>
  static void with_each_grounding(SkillList<Listed...>, auto&& use) {
    auto action = prepared_.grounded.actions.begin();
    int number = 0;
    const auto groundings_of = [&]<class Skill>(std::type_identity<Skill> skill) {
      for (; action != prepared_.grounded.actions.end() && action->skill == number; ++action) use(skill, parameters_of<Skill>(*action));
      ++number;
    };
    (groundings_of(std::type_identity<Listed>{}), ...);
  }
};

}
