// Random walks: what the rate of a model is measured by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/random.hpp"
#include "aos/step.hpp"

namespace aos {

// Many walks side by side, from initial states on, each with a new start at the end and at the horizon. In a round, the
// states for which the same action is drawn take it one after another: a processor foresees what runs next, and works on
// several steps at a time.
template <class Model>
class Walks {
 public:
  using State = typename Model::State;
  // As many as fit a processor's nearest cache, within reason.
  static constexpr int count = 16384 / sizeof(State) < 16    ? 16
                               : 16384 / sizeof(State) > 256 ? 256
                                                             : 16384 / sizeof(State);

  explicit Walks(Sampler& random) : random_(random), walks_(count) {
    for (Walk& walk : walks_) start(walk);
  }

  // One random action in each; the sum of the rewards.
  double round() {
    sort_by_action();
    double rewards = 0;
    int first = 0;
    for (int action = 0; action < static_cast<int>(ends_.size()); ++action) {
      const int end = ends_[static_cast<std::size_t>(action)];
      const auto state_at = [&](int place) -> State& {
        State& state = walks_[order_[place]].state;
        if (Model::ending(state) != Ending::running) __builtin_unreachable();
        return state;
      };
      if (first < end) rewards += Model::step_all(action, first, end, state_at, random_);
      first = end;
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
    walk = {};
    Model::initial(walk.state, random_);
  }

  // Draws the actions, and lists the walks in their order: those with action a end at ends_[a].
  void sort_by_action() {
    const int actions = Model::action_count();
    ends_.assign(static_cast<std::size_t>(actions), 0);
    for (int& action : actions_) ++ends_[static_cast<std::size_t>(action = random_.below(actions))];
    int sum = 0;
    for (int& end : ends_) {
      const int next = sum + end;
      end = sum;
      sum = next;
    }
    for (int walk = 0; walk < count; ++walk) {
      order_[ends_[static_cast<std::size_t>(actions_[walk])]++] = static_cast<std::size_t>(walk);
    }
  }

  Sampler& random_;
  std::vector<Walk> walks_;
  std::vector<int> ends_;
  int actions_[count];
  std::size_t order_[count];
};

struct Walked {
  std::uint64_t steps = 0;
  double rewards = 0;
};

// At least so many steps.
template <class Model>
[[gnu::flatten]] Walked walk(std::uint64_t steps, Sampler& random) {
  Sampler draws = random;  // what nothing else points to, a compiler keeps in registers
  Walks<Model> walks{draws};
  Walked walked;
  for (; walked.steps < steps; walked.steps += Walks<Model>::count) walked.rewards += walks.round();
  random = draws;
  return walked;
}

}  // namespace aos
