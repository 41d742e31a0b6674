// Model of the project armadillo: 7 state variables, 5 skills.
// Emitted by aos 0.1.0 from the documents of digest ac2a0cab5c5b19b3. Change the documents, not
// this file; `aos inspect BUNDLE --stage cpp` writes it anew. The #line directives give the documents' lines.
// Names that begin with `aos_` are this file's own.
//
// A document's `AOS.SampleDiscrete(Enum, weights)` is `Enum(AOS.SampleDiscrete(-1, weights))` here: the first
// argument is the number before the first that can be drawn, and the values of an enum count from 0.

#include "aos/model/model_support.hpp"

namespace model {

using namespace std;  // Documents write `vector` and `sqrt` without `std::`.
using anyValue = bool;

enum Place : std::int8_t { EasyTable, HardTable, Corridor, RobotHand, Unknown };
inline const char* name_of(Place value) {
  return aos::name_in({"EasyTable", "HardTable", "Corridor", "RobotHand", "Unknown"}, value);
}

struct Destination {
  Place place = Unknown;
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  template <class Self, class Visit>
  static void aos_fields(Self& self, Visit&& visit) {
    visit("place", self.place);
    visit("x", self.x);
    visit("y", self.y);
    visit("yaw", self.yaw);
  }
  bool operator==(const Destination&) const = default;
};

// The variables that no code changes. Every state refers to them.
struct Constants {
  Destination easy_table{};
  Destination hard_table{};
  Destination corridor{};
};
inline Constants constants;

// The variables that each particle holds.
struct State {
  Place easy_can_at{};
  Place hard_can_at{};
  Place robot_at{};
  bool holding_can{};
  bool arm_outstretched{};
  bool drink_served{};
  bool person_injured{};
  aos::Ending aos_ending{};
  inline static const Destination& easy_table = constants.easy_table;
  inline static const Destination& hard_table = constants.hard_table;
  inline static const Destination& corridor = constants.corridor;

  template <class Self, class Visit>
  static void aos_fields(Self& self, Visit&& visit) {
    visit("easy_can_at", self.easy_can_at);
    visit("hard_can_at", self.hard_can_at);
    visit("robot_at", self.robot_at);
    visit("holding_can", self.holding_can);
    visit("arm_outstretched", self.arm_outstretched);
    visit("drink_served", self.drink_served);
    visit("person_injured", self.person_injured);
  }
  static std::span<const aos::Member> aos_members();
  bool operator==(const State&) const = default;
};
inline constexpr std::array<aos::Member, 7> members{
    aos::member_at<Place>("easy_can_at", offsetof(State, easy_can_at)),
    aos::member_at<Place>("hard_can_at", offsetof(State, hard_can_at)),
    aos::member_at<Place>("robot_at", offsetof(State, robot_at)),
    aos::member_at<bool>("holding_can", offsetof(State, holding_can)),
    aos::member_at<bool>("arm_outstretched", offsetof(State, arm_outstretched)),
    aos::member_at<bool>("drink_served", offsetof(State, drink_served)),
    aos::member_at<bool>("person_injured", offsetof(State, person_injured)),
};
inline std::span<const aos::Member> State::aos_members() { return members; }

// All variables, writable for the code that gives them their first values.
struct Draft : State, Constants {
  using Constants::easy_table;
  using Constants::hard_table;
  using Constants::corridor;
};

// Sets the values that the documents declare, in the order of the declarations.
inline void default_values(Draft& state) {
  {
    aos::blame::at(5);
#line 16 "armadillo.ef"
state.easy_can_at = EasyTable;
#line 97 "model.cpp"
  }
  {
    aos::blame::at(6);
#line 20 "armadillo.ef"
state.hard_can_at = HardTable;
#line 103 "model.cpp"
  }
  {
    aos::blame::at(7);
#line 24 "armadillo.ef"
state.robot_at = Unknown;
#line 109 "model.cpp"
  }
  {
    aos::blame::at(8);
#line 28 "armadillo.ef"
state.holding_can = false;
#line 115 "model.cpp"
  }
  {
    aos::blame::at(9);
#line 32 "armadillo.ef"
state.arm_outstretched = false;
#line 121 "model.cpp"
  }
  {
    aos::blame::at(10);
#line 36 "armadillo.ef"
state.drink_served = false;
#line 127 "model.cpp"
  }
  {
    aos::blame::at(11);
#line 40 "armadillo.ef"
state.person_injured = false;
#line 133 "model.cpp"
  }
  {
    aos::blame::at(12);
#line 44 "armadillo.ef"
state.easy_table.place = EasyTable;
state.easy_table.x = 0.0;
state.easy_table.y = 2.0;
state.easy_table.yaw = 1.5708;
#line 142 "model.cpp"
  }
  {
    aos::blame::at(13);
#line 51 "armadillo.ef"
state.hard_table.place = HardTable;
state.hard_table.x = 0.0;
state.hard_table.y = -2.0;
state.hard_table.yaw = -1.5708;
#line 151 "model.cpp"
  }
  {
    aos::blame::at(14);
#line 58 "armadillo.ef"
state.corridor.place = Corridor;
state.corridor.x = 4.0;
state.corridor.y = 0.0;
state.corridor.yaw = 0.0;
#line 160 "model.cpp"
  }
  aos::blame::at(0);
}

// From navigate.sd.
struct aos_skill_navigate : aos::SkillDefaults {
  enum Response : int { arrived = 1, failed };
  static constexpr std::array<const char*, 2> response_names{"arrived", "failed"};
  static constexpr double violation_penalty = -10.0;

  struct Parameters {
    Destination destination;

    template <class Self, class Visit>
    static void aos_fields(Self& self, Visit&& visit) {
      visit("destination", self.destination);
    }
  };

  static void make_groundings(const Draft& aos_draft, aos::Groundings aos_groundings) {
    for (const auto& destination : std::initializer_list<aos::NamedValue<Destination>>{
             {"corridor", aos_draft.corridor},
             {"easy_table", aos_draft.easy_table},
             {"hard_table", aos_draft.hard_table},
         }) {
      aos_groundings.add({{"destination", destination.name}}, new Parameters{destination.value});
    }
  }

  static void precondition(const State& state, bool& __meetPrecondition, const Parameters& aos_parameters,
                           auto& AOS) {
    aos::blame::at(19);
#line 5 "navigate.sd"
__meetPrecondition = state.robot_at != Unknown;
#line 195 "model.cpp"
  }

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const Parameters& aos_parameters, auto& AOS) {
    const auto& destination = aos_parameters.destination;
    auto& __reward = aos_effect.reward;
    auto& __moduleResponse = aos_effect.response;
    aos::blame::at(20);
#line 9 "navigate.sd"
bool is_there = AOS.Bernoulli(1.0);
if (is_there) state__.robot_at = destination.place;
__moduleResponse = is_there ? arrived : failed;
__reward = -5;
#line 210 "model.cpp"
  }
};

// From observe_arm_outstretched.sd.
struct aos_skill_observe_arm_outstretched : aos::SkillDefaults {
  enum Response : int { outstretched = 1, not_outstretched };
  static constexpr std::array<const char*, 2> response_names{"outstretched", "not_outstretched"};
  static constexpr bool has_certain_rewards = true;

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const Parameters& aos_parameters, auto& AOS) {
    auto& __reward = aos_effect.reward;
    auto& __moduleResponse = aos_effect.response;
    aos::blame::at(21);
#line 4 "observe_arm_outstretched.sd"
__moduleResponse = state.arm_outstretched ? outstretched : not_outstretched;
__reward = -1;
#line 229 "model.cpp"
  }
};

// From observe_holding.sd.
struct aos_skill_observe_holding : aos::SkillDefaults {
  enum Response : int { holding = 1, not_holding };
  static constexpr std::array<const char*, 2> response_names{"holding", "not_holding"};
  static constexpr bool has_certain_rewards = true;

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const Parameters& aos_parameters, auto& AOS) {
    auto& __reward = aos_effect.reward;
    auto& __moduleResponse = aos_effect.response;
    aos::blame::at(22);
#line 4 "observe_holding.sd"
// In 2 of 11 runs the fingers report nothing although they hold the can; never the other way round.
__moduleResponse = state.holding_can && AOS.sensing().Bernoulli(0.818) ? holding : not_holding;
__reward = -1;
#line 249 "model.cpp"
  }
};

// From pick.sd.
struct aos_skill_pick : aos::SkillDefaults {
  enum Response : int { pick_succeeded = 1, pick_failed };
  static constexpr std::array<const char*, 2> response_names{"pick_succeeded", "pick_failed"};
  static constexpr double violation_penalty = -10.0;

  static void precondition(const State& state, bool& __meetPrecondition, const Parameters& aos_parameters,
                           auto& AOS) {
    aos::blame::at(23);
#line 4 "pick.sd"
bool can_in_reach = state.easy_can_at == state.robot_at || state.hard_can_at == state.robot_at;
__meetPrecondition = can_in_reach && !state.holding_can;
#line 265 "model.cpp"
  }

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const Parameters& aos_parameters, auto& AOS) {
    auto& __reward = aos_effect.reward;
    auto& __moduleResponse = aos_effect.response;
    aos::blame::at(24);
#line 9 "pick.sd"
enum Ending { Grasped, GraspedArmOut, NotGrasped, Dropped };

Ending ending = NotGrasped;
if (__meetPrecondition) ending = Ending(AOS.SampleDiscrete(-1, {0.5238, 0.0952, 0.0476, 0.4285}));
bool in_hand = ending == Grasped || ending == GraspedArmOut;

if (ending != NotGrasped) {
    Place can_at = in_hand ? RobotHand : Unknown;
    if (state.easy_can_at == state.robot_at) state__.easy_can_at = can_at;
    if (state.hard_can_at == state.robot_at) state__.hard_can_at = can_at;
}
state__.holding_can = in_hand;
state__.arm_outstretched = ending == GraspedArmOut;

// The skill notices an arm that stays out, and neither a missed nor a dropped can.
__moduleResponse = ending == GraspedArmOut ? pick_failed : pick_succeeded;
__reward = -2;
#line 292 "model.cpp"
  }
};

// From serve.sd.
struct aos_skill_serve : aos::SkillDefaults {
  enum Response : int { delivered = 1, not_delivered };
  static constexpr std::array<const char*, 2> response_names{"delivered", "not_delivered"};
  static constexpr bool has_certain_rewards = true;
  static constexpr double violation_penalty = -12.0;

  static void precondition(const State& state, bool& __meetPrecondition, const Parameters& aos_parameters,
                           auto& AOS) {
    aos::blame::at(25);
#line 4 "serve.sd"
__meetPrecondition = state.holding_can && !state.arm_outstretched && state.robot_at == Corridor;
#line 308 "model.cpp"
  }

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const Parameters& aos_parameters, auto& AOS) {
    auto& __reward = aos_effect.reward;
    auto& __moduleResponse = aos_effect.response;
    aos::blame::at(26);
#line 8 "serve.sd"
state__.person_injured = state.arm_outstretched;
state__.drink_served = __meetPrecondition && !state__.person_injured;

// All 21 runs reported a delivery, whether or not there was a can in the hand.
__moduleResponse = AOS.sensing().Bernoulli(1.0) ? delivered : not_delivered;
__reward = state__.person_injured ? -20 : -8;
#line 324 "model.cpp"
  }
};

struct Environment : aos::EnvironmentDefaults {
  static void initial_belief(State& state, auto& AOS) {
    aos::blame::at(15);
#line 64 "armadillo.ef"
state.robot_at = state.hard_table.place;
#line 333 "model.cpp"
  }

  static void aos_special_state_1(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(16);
#line 67 "armadillo.ef"
if (state.drink_served) {
    __reward = 30;
    __isGoalState = true;
}
#line 344 "model.cpp"
  }

  static void aos_special_state_2(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(17);
#line 73 "armadillo.ef"
if (state.person_injured) {
    __reward = -10;
    __isFailureState = true;
}
#line 355 "model.cpp"
  }

  static void aos_special_state_3(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(18);
#line 79 "armadillo.ef"
// Both cans are lost: nothing is left to serve.
if (state.easy_can_at == Unknown && state.hard_can_at == Unknown) {
    __isFailureState = true;
}
#line 366 "model.cpp"
  }

  static constexpr bool has_special_states = true;
  static double special_states(State& next, auto& random) {
    double reward = 0;
    reward += aos::special_state(next, 0u, [&](auto&... result) {
      aos_special_state_1(next, result..., random);
    });
    reward += aos::special_state<aos::Said::failures>(next, 0u, [&](auto&... result) {
      aos_special_state_2(next, result..., random);
    });
    reward += aos::special_state<aos::Said::failures>(next, 0u, [&](auto&... result) {
      aos_special_state_3(next, result..., random);
    });
    return reward;
  }
};

inline State start;
inline std::vector<aos::GroundedAction> actions;

// Calls `use` with the type of the skill.
decltype(auto) with_skill(int skill, auto&& use) {
  switch (skill) {
    case 0:
      return use(std::type_identity<aos_skill_navigate>{});
    case 1:
      return use(std::type_identity<aos_skill_observe_arm_outstretched>{});
    case 2:
      return use(std::type_identity<aos_skill_observe_holding>{});
    case 3:
      return use(std::type_identity<aos_skill_pick>{});
    default:
      return use(std::type_identity<aos_skill_serve>{});
  }
}

// Calls `use` with the type of the action's skill and with the action's parameters.
decltype(auto) with_action(int action, auto&& use) {
  const auto& chosen = actions[action];
  return with_skill(chosen.skill, [&]<class Skill>(std::type_identity<Skill> skill) -> decltype(auto) {
    return use(skill, aos::parameters_of<Skill>(chosen));
  });
}

// The model that the engine runs.
struct Model {
  using State = model::State;
  static constexpr const char* project = "armadillo";
  static constexpr int horizon = 10;
  static constexpr double discount = 0.99;
  static constexpr std::array<aos::SkillFacts, 5> skills{
      aos::facts_of<aos_skill_navigate>("navigate"),
      aos::facts_of<aos_skill_observe_arm_outstretched>("observe_arm_outstretched"),
      aos::facts_of<aos_skill_observe_holding>("observe_holding"),
      aos::facts_of<aos_skill_pick>("pick"),
      aos::facts_of<aos_skill_serve>("serve"),
  };
  // The variables on which no reward, observation or ending depends.
  static constexpr std::array<aos::ByteRange, 0> irrelevant{
  };
  static constexpr bool has_rollout_policy = false;
  static constexpr bool has_state_heuristic = false;
  static constexpr bool has_corrections = false;

  // Sets the constants and grounds the actions; call it once before anything else.
  static void prepare() {
    Draft draft;
    default_values(draft);
    constants = draft;
    start = draft;
    actions.clear();
    aos_skill_navigate::make_groundings(draft, {actions, 0, "navigate"});
    aos_skill_observe_arm_outstretched::make_groundings(draft, {actions, 1, "observe_arm_outstretched"});
    aos_skill_observe_holding::make_groundings(draft, {actions, 2, "observe_holding"});
    aos_skill_pick::make_groundings(draft, {actions, 3, "pick"});
    aos_skill_serve::make_groundings(draft, {actions, 4, "serve"});
    if (actions.empty()) throw aos::ModelFault{"AOS119", "no skill has a grounded action"};
  }

  static int action_count() { return static_cast<int>(actions.size()); }
  static constexpr const std::vector<aos::GroundedAction>& grounded_actions() { return model::actions; }

  static void initial(State& state, auto& random) {
    state = start;
    Environment::initial_belief(state, random);
    Environment::special_states(state, random);
    aos::blame::at(0);
  }
  static aos::Step step(State& state, int action, auto& random) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      return aos::step<Environment, Skill>(state, parameters, random);
    });
  }
  static bool meets_precondition(const State& state, int action, auto& random) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      return aos::meets_precondition<Skill>(state, parameters, random);
    });
  }
  static double rollout_weight(const State& state, int action, auto& random) {
    return with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      return aos::rollout_weight<Skill>(state, parameters, random);
    });
  }
  // Calls `take` with the weight of each action, in the order of the actions.
  static void rollout_weights(const State& state, auto& random, auto&& take) {
    const auto weigh = [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      take(aos::rollout_weight<Skill>(state, parameters, random));
    };
    aos::with_each_grounding<
        aos_skill_navigate,
        aos_skill_observe_arm_outstretched,
        aos_skill_observe_holding,
        aos_skill_pick,
        aos_skill_serve>(
        actions, weigh);
  }
  static void correct(const State& before, State& next, int action, auto& random) {
    with_action(action, [&]<class Skill>(std::type_identity<Skill>, const auto& parameters) {
      aos::correct<Environment, Skill>(before, next, parameters, random);
    });
  }
  static double state_value(const State& state, auto& random) {
    double value = 0;
    Environment::state_heuristic(state, value, random);
    aos::blame::at(0);
    return value;
  }

  static aos::Ending ending(const State& state) { return state.aos_ending; }
  static std::string state_text(const State& state) {
    return aos::leaves_text(state);
  }
  static std::uint64_t hash(const State& state) {
    const auto ended = static_cast<std::uint64_t>(state.aos_ending);
    return aos::mixed(aos::hashed(0, state), ended);
  }
  // The variables that differ between states, as text.
  static std::string save_state(const State& state) {
    aos::StateWriter text;
    text.write(state);
    text.write(state.aos_ending);
    return text.text();
  }
  // The variables that are the same in all states, as text.
  static aos::SavedConstants save_constants() { return {}; }
  // Both texts may come from documents in which other variables were constants.
  static void load_state(State& state, std::string_view saved, const aos::SavedConstants& constants) {
    aos::StateReader text{saved};
    constants.read_all(members, &state, text);
    text.read(state.aos_ending);
    text.finish();
  }
};

}  // namespace model

constinit const aos::ModelTable aos::compiled_model = aos::table_of<model::Model>();
