// Measures how fast a model steps in the way planners step it: one call a step, random actions, from initial
// states on. An episode ends with its state or at the horizon, and a new one begins.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/child/command.hpp"
#include "aos/model/endless_steps.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/listed/step_table.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/simulated_state.hpp"
#include "aos/text/json.hpp"

namespace aos {

// Steps for `seconds` and writes the number of steps. `start_state()` gives a state of simulated_state.hpp.
template <class Model, class StartState>
void write_rate(JsonWriter& json, double seconds, Sampler& random, StartState&& start_state) {
  const auto start = std::chrono::steady_clock::now();
  const auto processor_start = processor_time();
  std::chrono::duration<double> spent{};
  std::uint64_t samples = 0;
  double rewards = 0;
  std::uint64_t made = 0;  // steps and starts
  for (std::uint64_t next_look = 0; spent.count() < seconds;) {
    auto state = start_state();
    ++made;
    for (int left = Model::horizon; left > 0 && !state.has_ended(); --left, ++samples, ++made) {
      rewards += state.step(random.below(Model::action_count()), random).reward;
    }
    if (made < next_look) continue;
    spent = std::chrono::steady_clock::now() - start;
    next_look = made + std::min<std::uint64_t>(made, 1 << 16);
  }
  const std::chrono::duration<double> processor{processor_time() - processor_start};
  json.begin_object().member("samples", samples).member("seconds", spent.count());
  json.member("cpu_seconds", processor.count());
  json.member("mean_reward", samples > 0 ? rewards / samples : 0.0).end_object();
}

// Writes which loops had no end in steps of this process so far.
inline void write_endless_steps(JsonWriter& json) {
  json.begin_object().key("loops").begin_array();
  endless_steps().for_each([&](std::uint32_t loop, const EndlessSteps::Told& told) {
    json.begin_object().member("loop", loop).member("steps", told.steps).member("state", told.state).end_object();
  });
  json.end_array().end_object();
}

// Steps by the documents' code.
template <class Model>
void write_code_rate(JsonWriter& json, const Command& command) {
  Sampler random{command.number<std::uint64_t>("seed")};
  typename Model::State initial{};
  write_rate<Model>(json, command.number<double>("seconds"), random, [&] {
    Model::initial(initial, random);
    return ComputedState<Model>{initial, nullptr};
  });
}

// Steps by the table of a model with few states. Without a table there are no steps.
template <class Model>
void write_table_rate(JsonWriter& json, const Command& command) {
  Sampler random{command.number<std::uint64_t>("seed")};
  const auto belief = Belief<Model>::initial(random);
  StateSpace<Model> space;
  StepTable<Model> table;
  const bool is_there = space.reach(belief) && table.prepare(space, belief) && table.size() > 0;
  const MdpValues<Model> values{space};
  write_rate<Model>(json, is_there ? command.number<double>("seconds") : 0, random,
                    [&] { return ListedState<Model>{table, values, random}; });
}

}
