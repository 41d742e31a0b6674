// Grounded actions: a skill with values for its parameters.
#pragma once

#include <initializer_list>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace aos {

template <class Parameters>
struct Grounding {
  std::string name;
  Parameters parameters;
};

// `parameters` are of the skill's type; the grounding that holds them stays where it is.
struct GroundedAction {
  int skill = 0;
  const void* parameters = nullptr;
  const char* name = "";
};

template <class Skill>
const typename Skill::Parameters& parameters_of(const GroundedAction& action) {
  return *static_cast<const typename Skill::Parameters*>(action.parameters);
}

// A value that parameters of type T may take, and the variable that holds it.
template <class T>
struct NamedValue {
  const char* name;
  T value;
};

template <class T>
std::vector<NamedValue<T>> values(std::initializer_list<NamedValue<T>> values) {
  return values;
}

// `skill(parameter=value, ...)`; the skill alone where there are no parameters.
inline std::string action_name(const char* skill, std::initializer_list<std::pair<const char*, std::string>> parameters) {
  std::string list;
  for (const auto& [parameter, value] : parameters) {
    if (!list.empty()) list += ", ";
    list += std::string{parameter} + "=" + value;
  }
  return list.empty() ? skill : std::string{skill} + "(" + list + ")";
}

template <class Parameters>
void add_actions(std::vector<GroundedAction>& actions, int skill, const std::vector<Grounding<Parameters>>& groundings) {
  for (const auto& grounding : groundings) actions.push_back({skill, &grounding.parameters, grounding.name.c_str()});
}

// Calls `use` with a skill's type and the parameters of each of its groundings, skill by skill.
template <class... Skills>
void with_each_grounding(auto&& use) {
  const auto groundings_of = [&]<class Skill>(std::type_identity<Skill> skill) {
    for (const auto& grounding : Skill::groundings) use(skill, grounding.parameters);
  };
  (groundings_of(std::type_identity<Skills>{}), ...);
}

// Draws for code that runs once, before there is a particle: the likeliest outcome, the mean, the middle.
struct FixedDraws {
  bool Bernoulli(double probability) { return probability >= 0.5; }
  int SampleDiscrete(int name, std::initializer_list<double> weights) { return name + 1 + likeliest(weights); }
  template <class Weights>
  int SampleDiscrete(int name, const Weights& weights) {
    return name + 1 + likeliest(weights);
  }
  template <class Weights = std::initializer_list<double>>
  int SampleDiscrete(const Weights& weights) {
    return likeliest(weights);
  }
  double SampleNormal(double mean, double) { return mean; }
  double SampleUniform(double low, double high) { return (low + high) / 2; }
  void SetNull(bool& value) { value = false; }
  void Uninitialize(bool& value) { value = false; }
  void Initialize(bool& value) { value = true; }
  bool IsInitialized(bool value) { return value; }

 private:
  template <class Weights>
  static int likeliest(const Weights& weights) {
    int best = 0;
    double most = -1;
    int index = 0;
    for (const double weight : weights) {
      if (weight > most) {
        most = weight;
        best = index;
      }
      ++index;
    }
    return best;
  }
};

}  // namespace aos
