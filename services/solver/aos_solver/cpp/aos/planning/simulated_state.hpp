// The state in a simulation of a search. A ComputedState is a block of bytes that the documents' code steps.
// In a model with few states, a ListedState is the number of a state in a table.
#pragma once

#include <cstdint>

#include "aos/base/random.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/mdp_values.hpp"
#include "aos/planning/learned_values.hpp"
#include "aos/planning/step_table.hpp"

namespace aos {

template <class Model>
class ComputedState {
 public:
  using State = typename Model::State;

  // `values` are MDP values by value iteration, `estimates` are learned ones. Either may be null.
  ComputedState(const State& state, const MdpValues<Model>* values, const LearnedValues<Model>* estimates)
      : state_(state), values_(values), estimates_(estimates) {}

  Step step(int action, Sampler& random) { return Model::step(state_, action, random); }
  bool has_ended() const { return Model::ending(state_) != Ending::running; }
  // The fully observable value with `left` decisions to go; 0 if values are not known.
  double value(int left) const {
    if (values_ != nullptr) return values_->value(values_->number_of(state_), left);
    return estimates_ != nullptr ? estimates_->value(state_, left) : 0;
  }
  // The first return of a new history, beyond the value.
  double leaf(int left, Sampler& random) const { return is_valued() ? 0 : Model::rollout(state_, left, random); }
  // Writes each action's probability to begin a rollout to `odds`. Returns false if new histories have no rollout.
  bool rollout_odds(double* odds, Sampler& random) const {
    if (is_valued()) return false;
    Model::rollout_odds(state_, odds, random);
    return true;
  }

 private:
  bool is_valued() const { return values_ != nullptr || estimates_ != nullptr; }

  State state_;
  const MdpValues<Model>* values_;
  const LearnedValues<Model>* estimates_;
};

template <class Model>
class ListedState {
 public:
  // Draws a state of the belief that the table was prepared for.
  ListedState(const StepTable<Model>& steps, const MdpValues<Model>& values, Sampler& random)
      : steps_(steps), values_(values), number_(steps.start(random.bits())) {}

  Step step(int action, Sampler& random) {
    const auto& outcome = steps_.outcome(number_, action, random.bits());
    number_ = outcome.next;
    return outcome.step;
  }
  bool has_ended() const { return number_ == StepTable<Model>::ended; }
  double value(int left) const { return values_.value(number_, left); }
  double leaf(int, Sampler&) const { return 0; }
  bool rollout_odds(double*, Sampler&) const { return false; }

 private:
  const StepTable<Model>& steps_;
  const MdpValues<Model>& values_;
  std::uint32_t number_;
};

}  // namespace aos
