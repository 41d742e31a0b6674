// Actions as a rollout takes them (rollout.hpp), one by one: those of a random walk repeat, as those of some rollouts do.
#pragma once

#include "aos/model/rollout.hpp"

namespace aos {

template <class Model>
class RandomWalk {
 public:
  using State = typename Model::State;

  // An action that a rollout may take from the state, drawn anew.
  int draw(const State& state, Sampler& random) {
    find_odds(state, random);
    return random.choose(odds_.data(), Model::action_count(), 1);
  }

  // Begins another walk.
  void start() { repeats_ = 0; }
  int next(const State& state, Sampler& random) {
    find_odds(state, random);
    if (repeats_-- > 0 && odds_[action_] > 0) return action_;
    action_ = random.choose(odds_.data(), Model::action_count(), 1);
    repeats_ = drawn_repeats(random) - 1;
    return action_;
  }
  // Walks so many steps from the state, or to the end of the mission. Returns the number of steps.
  int take(State& state, int steps, Sampler& random) {
    start();
    int taken = 0;
    for (; taken < steps && Model::ending(state) == Ending::running; ++taken) Model::step(state, next(state, random), random);
    return taken;
  }
  // Walks from a belief so many times, and calls `see(before, after)` for each step.
  void explore(const auto& belief, int walks, int longest, Sampler& random, auto&& see) {
    for (int walk = 0; walk < walks; ++walk) {
      State state = belief.sample(random);
      start();
      for (int step = 0; step < longest && Model::ending(state) == Ending::running; ++step) {
        const State before = state;
        Model::step(state, next(state, random), random);
        see(before, state);
      }
    }
  }

 private:
  void find_odds(const State& state, Sampler& random) {
    odds_.resize(Model::action_count());
    Model::rollout_odds(state, odds_.data(), random);
  }

  int action_ = 0;
  int repeats_ = 0;
  List<double> odds_;
};

}
