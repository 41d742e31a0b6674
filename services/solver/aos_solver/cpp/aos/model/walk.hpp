// Random walks: what the rate of a model is measured by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/base/build_kind.hpp"
#include "aos/base/random.hpp"
#include "aos/model/step.hpp"

namespace aos {

// Many walks side by side, from initial states on, each with a new start at the end and at the horizon. In a round, the
// states for which the same action is drawn take it one after another: a processor foresees what runs next, and works on
// several steps at a time.
template <class Model>
class Walks {
 public:
  using State = typename Model::State;
  // As many as fit a processor's nearest cache, within reason; an even number.
  static constexpr int count = 16384 / sizeof(State) < 16    ? 16
                               : 16384 / sizeof(State) > 256 ? 256
                                                             : 16384 / sizeof(State) & ~std::size_t{1};

  explicit Walks(Sampler& random)
      : random_(random),
        actions_(Model::action_count()),
        walks_(count),
        hands_(static_cast<std::size_t>(actions_) * count),
        dealt_(static_cast<std::size_t>(actions_)) {
    for (Walk& walk : walks_) start(walk);
  }

  // One random action in each; the sum of the rewards.
  double round() {
    deal();
    double rewards = 0;
    for (int action = 0; action < actions_; ++action) {
      const std::uint8_t* const hand = hands_.data() + action * count;
      const auto state_at = [&](int place) -> State& {
        State& state = walks_[hand[place]].state;
        if (Model::ending(state) != Ending::running) __builtin_unreachable();
        return state;
      };
      rewards += Model::step_all(action, static_cast<int>(dealt_[action]), state_at, random_);
      dealt_[action] = 0;
    }
    for (Walk& walk : walks_) {
      if (++walk.depth == Model::horizon || Model::ending(walk.state) != Ending::running) [[unlikely]] start(walk);
    }
    return rewards;
  }

 private:
  struct Walk {
    State state{};
    int depth = 0;
  };

  void start(Walk& walk) {
    walk.depth = 0;
    Model::initial(walk.state, random_);
  }

  // Draws the actions, two of each number: the walks with action a are the first dealt_[a] of its hand.
  void deal() {
    Sampler draws = random_;
    for (int walk = 0; walk < count; walk += 2) {
      const std::uint64_t bits = draws.bits();
      take((bits >> 32) * actions_ >> 32, walk);
      take((bits & 0xffffffff) * actions_ >> 32, walk + 1);
    }
    random_ = draws;
  }
  void take(std::uint64_t action, int walk) {
    hands_[action * count + dealt_[action]++] = static_cast<std::uint8_t>(walk);
  }

  Sampler& random_;
  int actions_;
  std::vector<Walk> walks_;
  std::vector<std::uint8_t> hands_;
  std::vector<std::uint32_t> dealt_;
};

struct Walked {
  std::uint64_t steps = 0;
  double rewards = 0;
};

// At least so many steps.
template <class Model>
AOS_INLINING_ALL Walked walk(std::uint64_t steps, Sampler& random) {
  Sampler draws = random;  // what nothing else points to, a compiler keeps in registers
  Walks<Model> walks{draws};
  Walked walked;
  for (; walked.steps < steps; walked.steps += Walks<Model>::count) walked.rewards += walks.round();
  random = draws;
  return walked;
}

}  // namespace aos
