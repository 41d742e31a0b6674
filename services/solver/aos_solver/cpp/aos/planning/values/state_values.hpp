// What states are worth to a search: the common base of values that are computed and of values that are learned.
#pragma once

#include "aos/draws/random.hpp"

namespace aos {

template <class Model>
class StateValues {
 public:
  // The fully observable (MDP) value of a state with `left` decisions to go, or an estimate of it.
  virtual double value(const typename Model::State& state, int left) const = 0;

  // Writes to `worths` what each action is worth beyond the state's value, with many decisions to go.
  virtual void advantages(const typename Model::State& state, double* worths, Sampler& random) const = 0;

  // The value of an action with `left` decisions to go, under given luck.
  double stepped_value(typename Model::State state, int action, int left, Sampler luck) const {
    const Step step = Model::step(state, action, luck);
    return step.reward + (Model::ending(state) == Ending::running ? Model::discount * value(state, left - 1) : 0);
  }

 protected:
  ~StateValues() = default;
};

}
