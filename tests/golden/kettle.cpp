// Model of the project kettle: 4 state variables, 1 skills.
// Emitted by aos 0.1.0 from the documents of digest ce84e619a79ac22b. Change the documents, not
// this file; `aos inspect BUNDLE --stage cpp` writes it anew. The #line directives give the documents' lines.
// Names that begin with `aos_` are this file's own. `aos::blame::at(N)` notes that piece N of the documents
// runs, so that a crash or a hang is told at its line.

#include "aos/model/model_support.hpp"
#include "aos/model/objects.hpp"
#include "aos/model/table.hpp"
#include "aos/model/mission_parameters.hpp"

namespace model {

using namespace std;  // Documents write `vector` and `sqrt` without `std::`.
using anyValue = bool;

constexpr anyValue ___left_handle = true;

enum Water : std::int8_t { Cold, Warm, Boiling };
inline const char* name_of(Water value) {
  return aos::name_in({"Cold", "Warm", "Boiling"}, value);
}

struct Cup {
  bool is_full = false;
  anyValue handle{};

  template <class Self, class Visit>
  static void aos_fields(Self& self, Visit&& visit) {
    visit("is_full", self.is_full);
    visit("handle", self.handle);
  }
  bool operator==(const Cup&) const = default;
};

// The variables that no code changes. Every state refers to them.
struct Constants {
  Water wanted{};
  Cup left{};
};
inline Constants constants;

// The variables that each particle holds.
struct State {
  Water water{};
  Cup mine{};
  aos::Vector<bool, 2> seen{};
  aos::Table<int, aos::EnumAxis<Water, 3>, aos::RangeAxis<0, 3, 1>> poured_ml{};
  aos::Ending aos_ending{};
  std::uint8_t aos_spent{};
  inline static const Water& wanted = constants.wanted;
  inline static const Cup& left = constants.left;
  auto CupObjects() {
    return aos::objects<model::Cup, &State::mine>(*this);
  }
  auto CupObjects() const {
    return aos::objects<model::Cup, &State::mine>(*this);
  }

  template <class Self, class Visit>
  static void aos_fields(Self& self, Visit&& visit) {
    visit("water", self.water);
    visit("mine", self.mine);
    visit("seen", self.seen);
    visit("poured_ml", self.poured_ml);
  }
  static std::span<const aos::Member> aos_members();
  bool operator==(const State&) const = default;
};
inline constexpr std::array<aos::Member, 4> members{
    aos::member_at<Water>("water", offsetof(State, water)),
    aos::member_at<Cup>("mine", offsetof(State, mine)),
    aos::member_at<aos::Vector<bool, 2>>("seen", offsetof(State, seen)),
    aos::member_at<aos::Table<int, aos::EnumAxis<Water, 3>, aos::RangeAxis<0, 3, 1>>>("poured_ml",
        offsetof(State, poured_ml)),
};
inline std::span<const aos::Member> State::aos_members() { return members; }
// What the mission sets.
inline constexpr std::array<aos::Member, 1> aos_mission_parameters{
    aos::constant_member("wanted", constants.wanted),
};

// All variables, writable for the code that gives them their first values.
struct Draft : State, Constants {
  using Constants::wanted;
  using Constants::left;
};

// Sets the values that the documents declare, in the order of the declarations.
inline void default_values(Draft& state) {
  aos::blame::at(2); state.wanted = Boiling;
  aos::take_mission_value("wanted", state.wanted);
  aos::blame::at(3); state.water = Cold;
  aos::blame::at(4);
#line 20 "environment.ef"
  state.left.handle = ___left_handle;
#line 26 "environment.ef"
  aos::blame::at(5); state.seen = {false, false};
#line 100 "model.cpp"
}

// From pour.sd.
struct aos_skill_pour : aos::SkillDefaults {
  static constexpr const char* aos_name = "pour";
  enum aos_Response : int { poured = 1, spilt };
  static constexpr std::array<const char*, 2> response_names{"poured", "spilt"};
  static constexpr bool keeps_state = true;
  static constexpr bool keeps_state_ = true;
  static constexpr double violation_penalty = -1.5;

  struct aos_Parameters {
    Cup cup;

    template <class Self, class Visit>
    static void aos_fields(Self& self, Visit&& visit) {
      visit("cup", self.cup);
    }
  };

  static void make_groundings(const Draft& aos_draft, aos::Groundings aos_groundings) {
    for (const auto& cup : std::initializer_list<aos::NamedValue<Cup>>{
             {"left", aos_draft.left},
         }) {
      aos_groundings.add({{"cup", cup.name}}, new aos_Parameters{cup.value});
    }
  }

  static void precondition(const State& state, bool& __meetPrecondition, const aos_Parameters& aos_parameters,
                           auto& AOS) {
    for (auto* aos_each : state.CupObjects()) {
      auto each = *aos_each;
      aos::blame::at(12);
      if (each.is_full) {
        aos::blame::at(13);
#line 9 "pour.sd"
        __meetPrecondition = false;
#line 138 "model.cpp"
      }
    }
  }

  static void execution_time(const State& state, int& __moduleExecutionTime,
      const aos_Parameters& aos_parameters,
                             auto& AOS) {
    aos::blame::at(14);
#line 16 "pour.sd"
    __moduleExecutionTime = 4;
#line 149 "model.cpp"
  }

  static void next_state(const State& state, const State& state_, State& state__,
                         bool __meetPrecondition, const int __moduleExecutionTime, auto& aos_effect,
                         const aos_Parameters& aos_parameters, auto& AOS) {
    auto& __moduleResponse = aos_effect.response;
    for (auto* aos_each : state__.CupObjects()) {
      auto& each = *aos_each;
      aos::blame::at(15);
#line 21 "pour.sd"
      if (!each.is_full) {
#line 23 "pour.sd"
        aos::blame::at(16); each.is_full = AOS.Bernoulli(0.9);
#line 163 "model.cpp"
      }
    }
    aos::blame::at(17);
#line 26 "pour.sd"
    state__.seen[0] = true;
    state__.poured_ml[{state.water, 1}] += 50;
    __moduleResponse = state__.mine.is_full ? poured : spilt;
#line 171 "model.cpp"
  }

  static void rollout_policy(const State& state, double& __heuristicValue,
      const aos_Parameters& aos_parameters,
                             auto& AOS) {
    aos::blame::at(18);
#line 13 "pour.sd"
    __heuristicValue = 1;
#line 180 "model.cpp"
  }

  // The local variables of the abstraction mapping at the time of the response.
  struct aos_Locals {
    bool is_full;

    template <class Self, class Visit>
    static void aos_fields(Self& self, Visit&& visit) {
      visit("is_full", self.is_full);
    }
  };

  static void given_observation(const State& state__, State& state___, const aos_Parameters& aos_parameters,
                                const aos_Locals& aos_locals, auto& AOS) {
    auto& is_full = aos_locals.is_full;
    aos::blame::at(19);
#line 31 "pour.sd"
    state___.mine.is_full = is_full;
#line 199 "model.cpp"
  }
};

struct Environment : aos::EnvironmentDefaults {
  static void initial_belief(State& state, auto& AOS) {
    enum : int { Start = -1, tap, boiler };
    int start = 0;
    aos::blame::at(6);
#line 35 "environment.ef"
    start = AOS.SampleDiscrete(Start, {0.9, 0.1});
#line 38 "environment.ef"
    aos::blame::at(7); if (start == boiler) state.water = Warm;
#line 212 "model.cpp"
  }

  // The parameters of the chosen action, by skill; null for a skill that was not chosen.
  struct aos_Chosen {
    const aos_skill_pour::aos_Parameters* pour = nullptr;

    template <class Skill>
    explicit aos_Chosen(std::type_identity<Skill>, const typename Skill::aos_Parameters& parameters) {
      if constexpr (std::same_as<Skill, aos_skill_pour>) pour = &parameters;
    }
  };
  static constexpr bool has_extrinsic_changes = true;
  static void extrinsic_changes(const State& state, State& state_, double& __reward,
                                const int __moduleExecutionTime, const aos_Chosen& aos_chosen, auto& AOS) {
    const auto* pour = aos_chosen.pour;
    aos::blame::at(8);
#line 55 "environment.ef"
    if (pour != NULL && AOS.Bernoulli(0.1)) state_.water = Cold;
#line 231 "model.cpp"
  }

  static void aos_special_state_1(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(9);
    if (state.mine.is_full) {
      __reward = 10.0;
      __isGoalState = true;
    }
  }

  static void aos_special_state_2(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(10);
#line 46 "environment.ef"
    if (state.water == state.wanted) {
#line 248 "model.cpp"
      __reward = 1.0;
      __stopEvaluatingState = true;
    }
  }

  static void aos_special_state_3(const State& state, double& __reward, bool& __isGoalState,
                               bool& __isFailureState, bool& __stopEvaluatingState, auto& AOS) {
    aos::blame::at(11);
#line 51 "environment.ef"
    if (state.water == Cold)
        __reward = -0.1;
#line 260 "model.cpp"
  }

  static constexpr bool has_special_states = true;
  static double special_states(State& next, auto& random) {
    double reward = 0;
    reward += aos::special_state(next, 0u, [&](auto&... result) {
      aos_special_state_1(next, result..., random);
    });
    reward += aos::special_state(next, 1u, [&](auto&... result) {
      aos_special_state_2(next, result..., random);
    });
    reward += aos::special_state(next, 0u, [&](auto&... result) {
      aos_special_state_3(next, result..., random);
    });
    return reward;
  }
};

// The project, of which aos::ModelOf makes the model that the engine runs.
struct aos_project : aos::ProjectDefaults {
  using State = model::State;
  using Draft = model::Draft;
  using Environment = model::Environment;
  using Skills = aos::SkillList<aos_skill_pour>;
  static constexpr const char* name = "kettle";
  static constexpr int horizon = 8;
  static constexpr double discount = 0.95;
  static constexpr std::span<const aos::Member> variables{model::members};
  static constexpr std::span<const aos::Member> mission_parameters{model::aos_mission_parameters};
  static constexpr bool has_rollout_policy = true;
  static constexpr bool has_corrections = true;
  static constexpr std::array<aos::ByteRange, 2> irrelevant{
      aos::ByteRange{offsetof(State, seen), sizeof(State::seen)},
      aos::ByteRange{offsetof(State, poured_ml), sizeof(State::poured_ml)},
  };
  static void default_values(Draft& draft) { model::default_values(draft); }
  static void set_constants(const Draft& draft) {
    constants = draft;
  }
};

}  // namespace model

constinit const aos::ModelTable aos::compiled_model =
    aos::table_of<aos::ModelOf<model::aos_project>>();
