// What it costs from then on that a robot has done something: a bell that was rung too early, an alarm, a fall.
#pragma once

#include <algorithm>

#include "aos/base/switches.hpp"
#include "aos/draws/random.hpp"
#include "aos/planning/options/option_search.hpp"

namespace aos {

template <class Model>
class LaterCosts {
 public:
  using State = typename Model::State;
  static constexpr double steps_of_looking = 2;  // of the model, where it is no dearer later

  // For missions of so many steps, in which an action changes nothing and costs least among such; -1 without one.
  void begin(int horizon, int idle_action) {
    horizon_ = static_cast<std::size_t>(horizon);
    idle_action_ = idle_action;
  }

  // How much dearer it is, up to the horizon, to do nothing in the state after so many steps than in the one before them, and than after
  // as many steps without anything done: what the world does by itself is no doing of the robot. At most 0. The random numbers are
  // those of whatever comes next, so that nothing else changes.
  double of(std::size_t steps, const State& before, const State& after, const Sampler& random) const {
    if (!switches::later_costs || idle_action_ < 0 || Model::ending(after) != Ending::running || steps >= horizon_) return 0;
    const double now = idle_reward(after, random);
    double usual = idle_reward(before, random);
    if (now >= usual) return 0;
    State waited = before;
    Sampler luck = random;
    for (std::size_t step = 0; step < steps && Model::ending(waited) == Ending::running; ++step) Model::step(waited, idle_action_, luck);
    usual = std::min(usual, idle_reward(waited, random));
    return std::min(now - usual, 0.0) * (discounted_steps<Model>(static_cast<double>(horizon_)) - discounted_steps<Model>(static_cast<double>(steps)));
  }

 private:
  double idle_reward(State state, Sampler luck) const { return Model::step(state, idle_action_, luck).reward; }

  std::size_t horizon_ = 1;
  int idle_action_ = -1;
};

}
