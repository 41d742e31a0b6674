// Grounded actions: skills with values for their parameters. A model makes its actions once, at its start.
#pragma once

#include <deque>
#include <vector>

#include "aos/draws/random.hpp"
#include "aos/model/reflection.hpp"

namespace aos {

// An action in words: `name` is `skill(parameter=value, ...)`, or the skill's alone, and `arguments` are its parameters
// with the text of their values. A parameter that stands for a state variable has the variable's name.
struct ActionWords {
  std::string name;
  std::vector<std::pair<std::string, std::string>> arguments;
};

// `parameters` points to values of the skill's type. These and the words stay where they are.
struct GroundedAction {
  int skill = 0;
  const void* parameters = nullptr;
  const ActionWords* words = nullptr;
};

// What makes and destroys them is compiled with the engine.
struct GroundedActions {
  std::vector<GroundedAction> actions;
  std::deque<ActionWords> words;  // the elements of a deque stay where they are

  GroundedActions();
  GroundedActions(const GroundedActions&) = delete;
  GroundedActions& operator=(const GroundedActions&) = delete;
  ~GroundedActions();
  void clear();
};

template <class Skill>
const typename Skill::aos_Parameters& parameters_of(const GroundedAction& action) {
  return *static_cast<const typename Skill::aos_Parameters*>(action.parameters);
}

// A value that parameters of type T may take, and the variable that holds it.
template <class T>
struct NamedValue {
  const char* name;
  T value;
};

// Describes a skill, apart from its dynamic model.
struct SkillFacts {
  const char* name;
  const char* const* responses;
  int response_count;
  bool has_text_response;
  int number_count;  // how many names `__observed` has
  bool has_alike_groundings;
  bool has_certain_rewards;
  void (*write_parameters)(const void* parameters, JsonWriter& json);
  void (*read_locals)(std::string_view values);
};

template <class Skill>
constexpr SkillFacts facts_of(void (*read_locals)(std::string_view values)) {
  return {
      .name = Skill::aos_name,
      .responses = Skill::response_names.data(),
      .response_count = static_cast<int>(Skill::response_names.size()),
      .has_text_response = Skill::has_text_response,
      .number_count = Skill::number_count,
      .has_alike_groundings = Skill::has_alike_groundings,
      .has_certain_rewards = Skill::has_certain_rewards,
      .write_parameters = [](const void* parameters, JsonWriter& json) {
        write_json(json, *static_cast<const typename Skill::aos_Parameters*>(parameters));
      },
      .read_locals = read_locals,
  };
}

struct Argument {
  std::string_view parameter;
  std::string_view value;
};

class Groundings {
 public:
  Groundings(GroundedActions& all, int skill, const char* name) : all_(all), skill_(skill), name_(name) {}

  // `parameters` are of the skill's type and must outlive the actions.
  void add(std::initializer_list<Argument> arguments, const void* parameters);

 private:
  GroundedActions& all_;
  int skill_;
  const char* name_;
};

// Draws for code that runs once, before there are particles: the likeliest outcome, the mean, the middle.
struct FixedDraws : Draws<FixedDraws> {
  static bool flag(double probability) { return probability >= 0.5; }
  static int choose(const double* weights, int count, double) {
    return static_cast<int>(std::max_element(weights, weights + count) - weights);
  }
  static double uniform() { return 0.5; }
};

}
