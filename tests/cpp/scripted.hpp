// Runs an emitted model on a script: the draws come from the script, and what the model does is printed as JSON.
// Stands where the engine child stands, so that tests see the model alone.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/model/support.hpp"

namespace aos {

// The built-ins that a source of draws has besides `index(weights)` and its distributions.
template <class Source>
class ScriptedDraws {
 public:
  Source& sensing() { return source(); }
  template <class Weights = std::initializer_list<double>>
  int SampleDiscrete(int name, const Weights& weights) {
    return name + 1 + source().index(weights, true);
  }
  template <class Enum, class Weights = std::initializer_list<double>>
    requires std::is_enum_v<Enum>
  Enum SampleDiscrete(const Weights& weights) {
    return static_cast<Enum>(source().index(weights, true));
  }
  template <class Weights = std::initializer_list<double>>
    requires(!std::is_enum_v<Weights>)
  int SampleDiscrete(const Weights& weights) {
    return source().index(weights, false);
  }
  template <class Value, class Weights = std::initializer_list<double>>
  Value SampleOf(std::initializer_list<Value> values, const Weights& weights) {
    return values.begin()[source().index(weights, true)];
  }
  template <class Values, class Weights = std::initializer_list<double>>
  decltype(auto) SampleOf(Values& values, const Weights& weights) {
    return values.at(source().index(weights, true));
  }
  void SetNull(bool& value) { value = false; }
  void Uninitialize(bool& value) { value = false; }
  void Initialize(bool& value) { value = true; }
  bool IsInitialized(bool value) { return value; }
  void report(NumberKey, const Distribution&) {}

 private:
  Source& source() { return static_cast<Source&>(*this); }
};

// Takes each draw from a list: a Bernoulli is true for 1, a discrete draw is the index itself. After the end of the list
// the likelier, or the first, value.
class Script : public ScriptedDraws<Script> {
 public:
  explicit Script(const char* draws) : rest_(draws) {}
  bool Bernoulli(double probability) { return next(probability >= 0.5 ? 1 : 0) != 0; }
  int index(const auto&, bool) { return static_cast<int>(next(0)); }
  double SampleNormal(double mean, double) { return next(mean); }
  double SampleUniform(double low, double) { return next(low); }

 private:
  double next(double otherwise) {
    char* end = nullptr;
    const double value = std::strtod(rest_, &end);
    if (end == rest_) return otherwise;
    rest_ = end;
    return value;
  }
  const char* rest_;
};

// A quick generator for long walks and for the rate.
class Dice : public ScriptedDraws<Dice> {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t mixed = state_ += 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    return mixed ^ (mixed >> 31);
  }
  int below(int count) { return static_cast<int>((bits() >> 32) * static_cast<std::uint64_t>(count) >> 32); }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  bool Bernoulli(double probability) { return uniform() < probability; }
  // Without `scales` the weights may leave a share in which no index is drawn.
  int index(const auto& weights, bool scales) {
    double sum = 0;
    for (const double weight : weights) sum += weight;
    return pick(weights, uniform() * (scales ? sum : 1));
  }
  double SampleNormal(double mean, double sigma) { return mean + sigma * (uniform() + uniform() + uniform() - 1.5) * 2; }
  double SampleUniform(double low, double high) { return low + uniform() * (high - low); }

 private:
  template <class Weights>
  static int pick(const Weights& weights, double left) {
    int index = 0;
    int last = -1;
    double sum = 0;
    for (const double weight : weights) {
      if (weight > 0) last = index;
      sum += weight;
      if (left < sum) return index;
      ++index;
    }
    return sum > 1 - 1e-5 ? last : -1;
  }
  std::uint64_t state_;
};

template <class Model>
std::string observation_name(int action, Observation observation) {
  if (observation == default_observation) return default_observation_text;
  if (observation < 0) return std::string{observation_text(observation)};
  const int skill = Model::grounded_actions()[static_cast<std::size_t>(action)].skill;
  return Model::skills()[static_cast<std::size_t>(skill)].responses[observation];
}

template <class Model>
void print_state(JsonWriter& json, const typename Model::State& state) {
  json.begin_object();
  NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) { json.member(name, leaf_text(leaf)); }};
  visit_value(state, leaves);
  json.end_object();
}

template <class Model>
int find_action(const std::string& name) {
  for (int action = 0; action < Model::action_count(); ++action) {
    if (name == Model::grounded_actions()[static_cast<std::size_t>(action)].name) return action;
  }
  std::exit(3);
}

inline bool read_line(std::string& line) {
  line.clear();
  for (int character = std::getchar(); character != EOF; character = std::getchar()) {
    if (character == '\n') return true;
    line += static_cast<char>(character);
  }
  return false;
}

// Each line of the script is an action's name, and after a `|` the draws of its step; the first line is the draws of the
// initial belief.
template <class Model>
void play() {
  std::string line;
  read_line(line);
  typename Model::State state;
  Script first{line.c_str()};
  Model::initial(state, first);
  JsonWriter json;
  json.begin_array().begin_object().key("state");
  print_state<Model>(json, state);
  json.member("ending", static_cast<int>(Model::ending(state))).end_object();
  while (read_line(line)) {
    const auto bar = line.find('|');
    const int action = find_action<Model>(line.substr(0, bar));
    Script draws{bar == std::string::npos ? "" : line.c_str() + bar + 1};
    Script none{""};
    json.begin_object().member("meets_precondition", Model::meets_precondition(state, action, none));
    std::vector<double> weights;
    Model::rollout_weights(state, none, [&](double weight) { weights.push_back(weight); });
    json.member("rollout_weight", weights[static_cast<std::size_t>(action)]);
    json.member("state_value", Model::state_value(state, none));
    const Step step = Model::step(state, action, draws);
    json.member("reward", step.reward).member("observation", observation_name<Model>(action, step.observation));
    json.key("state");
    print_state<Model>(json, state);
    typename Model::State loaded{};
    Model::load_state(loaded, Model::save_state(state), Model::save_constants());
    json.member("is_saved", loaded == state && Model::hash(loaded) == Model::hash(state));
    json.member("ending", static_cast<int>(Model::ending(state))).end_object();
  }
  std::puts(json.end_array().text().c_str());
}

template <class Model>
void walk(std::uint64_t seed, long steps) {
  Dice dice{seed};
  typename Model::State state;
  Model::initial(state, dice);
  long ended = 0;
  double sum = 0;
  for (long count = 0; count < steps; ++count) {
    sum += Model::step(state, dice.below(Model::action_count()), dice).reward;
    const bool has_ended = Model::ending(state) != Ending::running;
    if (has_ended || count % 50 == 49) Model::initial(state, dice);
    ended += has_ended;
  }
  JsonWriter json;
  json.begin_object().member("steps", steps).member("ended", ended).member("reward", sum).end_object();
  std::puts(json.text().c_str());
}

template <class Model>
void describe() {
  JsonWriter json;
  json.begin_array();
  for (const GroundedAction& action : Model::grounded_actions()) {
    json.begin_object().member("action", action.name).key("parameters");
    Model::skills()[static_cast<std::size_t>(action.skill)].write_parameters(action.parameters, json);
    json.end_object();
  }
  std::puts(json.end_array().text().c_str());
}

template <class Model>
int run(int argc, char** argv) {
  static_assert(std::is_trivially_copyable_v<typename Model::State>);
  const std::string mode = argc > 1 ? argv[1] : "";
  try {
    Model::prepare();
    if (mode == "play") play<Model>();
    if (mode == "describe") describe<Model>();
    if (mode == "walk") walk<Model>(std::strtoull(argv[2], nullptr, 10), std::strtol(argv[3], nullptr, 10));
  } catch (const ModelFault& fault) {
    JsonWriter json;
    json.begin_object().member("fault", fault.code).member("text", fault.text);
    json.member("piece", blame::piece()).end_object();
    std::puts(json.text().c_str());
  }
  return 0;
}

}  // namespace aos
