// How fast a model is stepped, in the way in which planners step it: one call for each step, with random actions, from
// initial states on, with a new start at the end and at the horizon.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "aos/base/clock.hpp"
#include "aos/base/json.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/child/command.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/state_space.hpp"
#include "aos/planning/step_table.hpp"

namespace aos {

// By the documents' code.
template <class Model>
class CodeSteps {
 public:
  explicit CodeSteps(std::uint64_t seed) : random_(seed) { start(); }

  // The reward of one step.
  double next() {
    const Step step = Model::step(state_, random_.below(Model::action_count()), random_);
    if (--left_ == 0 || Model::ending(state_) != Ending::running) start();
    return step.reward;
  }

 private:
  void start() {
    Model::initial(state_, random_);
    left_ = Model::horizon;
  }

  Sampler random_;
  typename Model::State state_{};
  int left_ = 0;
};

// By the table of a model with few states.
template <class Model>
class TableSteps {
 public:
  explicit TableSteps(std::uint64_t seed) : random_(seed) {
    const auto belief = Belief<Model>::initial(random_);
    StateSpace<Model> space;
    is_there_ = space.reach(belief) && table_.prepare(space, belief) && table_.size() > 0;
    if (is_there_) start();
  }

  // Whether the model has a table.
  bool is_there() const { return is_there_; }

  double next() {
    const auto& outcome = table_.outcome(state_, random_.below(Model::action_count()), random_.bits());
    state_ = outcome.next;
    if (--left_ == 0 || state_ == StepTable<Model>::ended) start();
    return outcome.step.reward;
  }

 private:
  void start() {
    do state_ = table_.start(random_.bits());
    while (state_ == StepTable<Model>::ended);
    left_ = Model::horizon;
  }

  Sampler random_;
  StepTable<Model> table_;
  bool is_there_ = false;
  std::uint32_t state_ = 0;
  int left_ = 0;
};

// Takes steps for so long and tells how many there were.
template <class Steps>
void write_rate(JsonWriter& json, double seconds, Steps&& steps) {
  const auto start = std::chrono::steady_clock::now();
  const auto processor_start = processor_time();
  std::chrono::duration<double> spent{};
  std::uint64_t samples = 0;
  double rewards = 0;
  for (std::uint64_t count = 64; spent.count() < seconds; count = std::min<std::uint64_t>(2 * count, 1 << 16)) {
    for (std::uint64_t i = 0; i < count; ++i) rewards += steps.next();
    samples += count;
    spent = std::chrono::steady_clock::now() - start;
  }
  const std::chrono::duration<double> processor{processor_time() - processor_start};
  json.begin_object().member("samples", samples).member("seconds", spent.count());
  json.member("cpu_seconds", processor.count());
  json.member("mean_reward", samples > 0 ? rewards / static_cast<double>(samples) : 0.0).end_object();
}

// How fast planners step the model by the documents' code.
template <class Model>
void write_code_rate(JsonWriter& json, const Command& command) {
  const auto seconds = command.number<double>("seconds");
  write_rate(json, seconds, CodeSteps<Model>{command.number<std::uint64_t>("seed")});
}

// The same by the table of a small model; none where there is no table.
template <class Model>
void write_table_rate(JsonWriter& json, const Command& command) {
  const auto seconds = command.number<double>("seconds");
  TableSteps<Model> steps{command.number<std::uint64_t>("seed")};
  write_rate(json, steps.is_there() ? seconds : 0, steps);
}

}  // namespace aos
