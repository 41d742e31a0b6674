// The program around an emitted model: see scripted.hpp. What the model does is printed as JSON.
//
//   scripted play             the script on standard input: the draws of the initial belief, then a line for each action
//   scripted describe         the grounded actions
//   scripted walk SEED STEPS  random actions
#include <cstdio>

#include "aos/model/model_support.hpp"
#include "aos/model/support.hpp"
#include "aos/model/values.hpp"
#include "aos/text/json.hpp"
#include "scripted.hpp"

namespace aos {

bool ScriptedDraws::Bernoulli(double probability) {
  if (rest_ == nullptr) return uniform() < probability;
  return next(probability >= 0.5 ? 1 : 0) != 0;
}

double ScriptedDraws::SampleNormal(double mean, double sigma) {
  if (rest_ == nullptr) return mean + sigma * (uniform() + uniform() + uniform() - 1.5) * 2;
  return next(mean);
}

double ScriptedDraws::SampleUniform(double low, double high) {
  return rest_ == nullptr ? low + uniform() * (high - low) : next(low);
}

int ScriptedDraws::below(int count) {
  return static_cast<int>((bits() >> 32) * static_cast<std::uint64_t>(count) >> 32);
}

int ScriptedDraws::chosen(const double* weights, std::size_t count, bool scales) {
  if (rest_ != nullptr) return static_cast<int>(next(0));
  double total = 0;
  for (std::size_t index = 0; index < count; ++index) total += weights[index];
  double rest = uniform() * (scales ? total : 1);
  int last = -1;
  for (std::size_t index = 0; index < count; ++index) {
    if (weights[index] > 0) last = static_cast<int>(index);
    if ((rest -= weights[index]) < 0) return static_cast<int>(index);
  }
  return total > 1 - 1e-5 ? last : -1;
}

double ScriptedDraws::next(double otherwise) {
  char* end = nullptr;
  const double value = std::strtod(rest_, &end);
  if (end == rest_) return otherwise;
  rest_ = end;
  return value;
}

std::uint64_t ScriptedDraws::bits() {
  std::uint64_t mixed = state_ += 0x9e3779b97f4a7c15u;
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9u;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
  return mixed ^ (mixed >> 31);
}

double ScriptedDraws::uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

namespace {

const ScriptedModel& model = scripted_model;

struct State {
  aos::List<std::max_align_t> block =
      aos::List<std::max_align_t>(model.state_bytes / sizeof(std::max_align_t) + 1);
  void* data() { return block.data(); }
};

const GroundedAction& action_at(int action) { return (*model.actions)[static_cast<std::size_t>(action)]; }
const SkillFacts& skill_of(int action) { return model.skills[static_cast<std::size_t>(action_at(action).skill)]; }

std::string observation_name(int action, Observation observation) {
  if (observation == default_observation) return default_observation_text;
  if (observation < 0) return std::string{observation_text(observation)};
  return skill_of(action).responses[observation];
}

void print_state(JsonWriter& json, State& state) {
  json.key("state").begin_object();
  NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) { json.member(name, leaf_text(leaf)); }};
  model.visit(state.data(), leaves);
  json.end_object();
}

int find_action(const std::string& name) {
  for (int action = 0; action < static_cast<int>(model.actions->size()); ++action) {
    if (name == action_at(action).words->name) return action;
  }
  std::exit(3);
}

bool read_line(std::string& line) {
  line.clear();
  for (int character = std::getchar(); character != EOF; character = std::getchar()) {
    if (character == '\n') return true;
    line += static_cast<char>(character);
  }
  return false;
}

// Each line of the script is an action's name, and after a `|` the draws of its step.
void play() {
  std::string line;
  read_line(line);
  State state;
  ScriptedDraws first{line.c_str()};
  model.initial(state.data(), first);
  JsonWriter json;
  json.begin_array().begin_object();
  print_state(json, state);
  json.member("ending", static_cast<int>(model.ending(state.data()))).end_object();
  while (read_line(line)) {
    const auto bar = line.find('|');
    const int action = find_action(line.substr(0, bar));
    ScriptedDraws draws{bar == std::string::npos ? "" : line.c_str() + bar + 1};
    ScriptedDraws none{""};
    json.begin_object().member("meets_precondition", model.meets_precondition(state.data(), action, none));
    json.member("rollout_weight", model.rollout_weights(state.data(), none)[static_cast<std::size_t>(action)]);
    json.member("state_value", model.state_value(state.data(), none));
    const Step step = model.step(state.data(), action, draws);
    json.member("reward", step.reward).member("observation", observation_name(action, step.observation));
    print_state(json, state);
    json.member("is_saved", model.is_saved(state.data()));
    json.member("ending", static_cast<int>(model.ending(state.data()))).end_object();
  }
  std::puts(json.end_array().text().c_str());
}

void walk(std::uint64_t seed, long steps) {
  ScriptedDraws dice{seed};
  State state;
  model.initial(state.data(), dice);
  long ended = 0;
  double sum = 0;
  for (long count = 0; count < steps; ++count) {
    sum += model.step(state.data(), dice.below(static_cast<int>(model.actions->size())), dice).reward;
    const bool has_ended = model.ending(state.data()) != Ending::running;
    if (has_ended || count % 50 == 49) model.initial(state.data(), dice);
    ended += has_ended;
  }
  JsonWriter json;
  json.begin_object().member("steps", steps).member("ended", ended).member("reward", sum).end_object();
  std::puts(json.text().c_str());
}

void describe() {
  JsonWriter json;
  json.begin_array();
  for (int action = 0; action < static_cast<int>(model.actions->size()); ++action) {
    json.begin_object().member("action", action_at(action).words->name).key("parameters");
    skill_of(action).write_parameters(action_at(action).parameters, json);
    json.end_object();
  }
  std::puts(json.end_array().text().c_str());
}

}  // namespace
}  // namespace aos

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  try {
    aos::model.prepare();
    if (mode == "play") aos::play();
    if (mode == "describe") aos::describe();
    if (mode == "walk") aos::walk(std::strtoull(argv[2], nullptr, 10), std::strtol(argv[3], nullptr, 10));
  } catch (const aos::ModelFault& fault) {
    aos::JsonWriter json;
    json.begin_object().member("fault", fault.code).member("text", fault.text);
    json.member("piece", aos::blame::piece()).end_object();
    std::puts(json.text().c_str());
  }
  return 0;
}
