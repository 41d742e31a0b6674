// The state in a simulation of a search. A ComputedState is a block of bytes that the documents' code steps.
// In a model with few states, a ListedState is the number of a state in a table.
#pragma once

#include "aos/planning/listed/step_table.hpp"
#include "aos/planning/pomcp/observation_doubts.hpp"
#include "aos/planning/values/few_outcomes.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

template <class Model>
class ComputedState {
 public:
  using State = typename Model::State;

  // `values` is null if nothing is known of what states are worth.
  ComputedState(const State& state, const StateValues<Model>* values) : state_(state), values_(values) {}

  Step step(int action, Sampler& random) { return Model::step(state_, action, random); }
  // The expected reward of an action, where steps draw it and its outcomes are few.
  std::optional<double> expected_reward(int action, ExpectedRewards<Model>& rewards) const {
    return rewards.of(state_, action);
  }
  // See ObservationDoubts.
  std::optional<double> doubt(int action, ObservationDoubts<Model>& doubts) const { return doubts.of(state_, action); }
  bool has_ended() const { return Model::ending(state_) != Ending::running; }
  // The value with `left` decisions to go; 0 if values are not known.
  [[gnu::always_inline]] double value(int left) const { return values_ != nullptr ? values_->value(state_, left) : 0; }
  // See StateValues. Values have to be known.
  void advantages(double* worths, Sampler& random) const { values_->advantages(state_, worths, random); }
  // The first return of a new history, beyond the value.
  double leaf(int left, Sampler& random) const { return values_ != nullptr ? 0 : Model::rollout(state_, left, random); }
  // Writes each action's probability to begin a rollout to `odds`. Returns false if new histories have no rollout.
  bool rollout_odds(double* odds, Sampler& random) const {
    if (values_ != nullptr) return false;
    Model::rollout_odds(state_, odds, random);
    return true;
  }

 private:
  State state_;
  const StateValues<Model>* values_;
};

template <class Model>
class ListedState {
 public:
  // Draws a state of the belief that the table was prepared for.
  ListedState(const StepTable<Model>& steps, const MdpValues<Model>& values, Sampler& random)
      : steps_(steps), values_(values), number_(steps.start(random.bits())) {}

  [[gnu::always_inline]] Step step(int action, Sampler& random) {
    const auto& outcome = steps_.outcome(number_, action, random.bits());
    number_ = outcome.next;
    return outcome.step;
  }
  std::optional<double> expected_reward(int, ExpectedRewards<Model>&) const { return {}; }
  std::optional<double> doubt(int, ObservationDoubts<Model>&) const { return {}; }
  bool has_ended() const { return number_ == StepTable<Model>::ended; }
  [[gnu::always_inline]] double value(int left) const { return values_.value(number_, left); }
  double leaf(int, Sampler&) const { return 0; }
  bool rollout_odds(double*, Sampler&) const { return false; }
  void advantages(double* worths, Sampler&) const { values_.advantages(number_, worths); }

 private:
  const StepTable<Model>& steps_;
  const MdpValues<Model>& values_;
  std::uint32_t number_;
};

}
