// The actions of a random walk. They repeat, as those of some rollouts do (rollout.hpp).
#pragma once

#include <cstddef>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/model/rollout.hpp"

namespace aos {

template <class Model>
class RandomWalk {
 public:
  using State = typename Model::State;

  // Begins another walk.
  void start() { repeats_ = 0; }

  // The next action, one that a rollout may take from the state.
  int next(const State& state, Sampler& random) {
    odds_.resize(static_cast<std::size_t>(Model::action_count()));
    Model::rollout_odds(state, odds_.data(), random);
    if (repeats_-- > 0 && odds_[static_cast<std::size_t>(action_)] > 0) return action_;
    action_ = random.choose(odds_.data(), Model::action_count(), 1);
    repeats_ = drawn_repeats(random) - 1;
    return action_;
  }

 private:
  int action_ = 0;
  int repeats_ = 0;
  std::vector<double> odds_;
};

}  // namespace aos
