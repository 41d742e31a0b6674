// The step at which a mission is over whatever the robot does, as a stall that closes or a shift that ends.
#pragma once

#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/values/running_down.hpp"

namespace aos {

// Takes a random action after which the mission goes on, if a few tries find one. Returns whether one did; else the state is as it was.
template <class Model>
bool goes_on(typename Model::State& state, Sampler& random) {
  constexpr int tries = 4;
  for (int i = 0; i < tries; ++i) {
    typename Model::State next = state;
    Model::step(next, random.below(Model::action_count()), random);
    if (Model::ending(next) != Ending::running) continue;
    state = std::move(next);
    return true;
  }
  return false;
}

// How many steps are left until then; infinite without such a deadline. All random walks that avoid other ends are over at the same step, and would go on if
// what runs down was what it was at first. So a battery that can be charged sets no deadline, though few walks come to a charger. The few steps are not counted.
template <class Model>
double steps_to_deadline(const SampledBelief<Model>& belief, const RunningDown<Model>& running_down, Sampler random) {
  constexpr std::size_t walks = 8;
  constexpr int longest = 64;
  constexpr double none = std::numeric_limits<double>::infinity();
  double deadline = none;
  for (std::size_t walk = 0; walk < walks; ++walk) {
    typename Model::State state = belief.states()[walk * belief.size() / walks];
    int step = 1;
    while (goes_on<Model>(state, random)) {
      if (++step > longest) return none;
    }
    running_down.set_back(state);
    if ((walk > 0 && step != deadline) || !goes_on<Model>(state, random)) return none;
    deadline = step;
  }
  return deadline;
}

}
