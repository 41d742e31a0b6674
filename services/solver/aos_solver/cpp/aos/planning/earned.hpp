// What is earned step by step, discounted to the first of the steps.
#pragma once

#include "aos/model/step.hpp"

namespace aos {

template <class Model>
struct Earned {
  double sum = 0;
  double discount = 1;  // of the next step

  void add(double reward) {
    sum += discount * reward;
    discount *= Model::discount;
  }
};

// Calls `step(i)`, which takes a step from the state and returns its reward, at most so often, and up to the end of the mission.
template <class Model>
Earned<Model> earned_in(std::size_t steps, const typename Model::State& state, auto&& step, Earned<Model> earned = {}) {
  for (std::size_t i = 0; i < steps && Model::ending(state) == Ending::running; ++i) earned.add(step(i));
  return earned;
}

}
