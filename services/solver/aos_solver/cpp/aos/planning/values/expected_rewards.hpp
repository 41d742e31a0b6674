// The expected reward of a step, where its outcomes are few.
//
// A search that draws rewards learns of a loss of 100,000 with a probability of 1e-4 from one simulation in 10,000,
// and prefers whatever action has not met it yet. So the rewards of a simulation's first steps count by their
// expectation, and what is left to chance is the next state (a Rao-Blackwell estimate). The second step counts as the
// first one does, since the search keeps what it found there for the next decision.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/fault.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"

namespace aos {

template <class Model>
class ExpectedRewards {
 public:
  ExpectedRewards() : is_left_out_(static_cast<std::size_t>(Model::action_count())) {
    for (int action = 0; action < Model::action_count(); ++action) {
      is_left_out_[static_cast<std::size_t>(action)] = Model::has_certain_rewards(Model::skill_of(action));
    }
    paths_.report_to(&ignored_numbers);
  }

  // Nothing if the reward is certain, or if an action has had too many outcomes once, or a continuous draw that does
  // not count by its mean.
  std::optional<double> of(const typename Model::State& state, int action) {
    if (is_left_out_[static_cast<std::size_t>(action)]) return {};
    double sum = 0;
    double reward = 0;
    const auto run = [&](Enumerator& path) {
      next_ = state;
      reward = Model::step(next_, action, path).reward;
    };
    const auto add = [&](Enumerator& path) { sum += reward * path.probability(); };
    try {
      paths_.for_nearly_each_path(run, add, max_reward_paths);
      return sum;
    } catch (const NotEnumerable&) {
    } catch (const ModelFault&) {  // a path that may never be drawn
    }
    is_left_out_[static_cast<std::size_t>(action)] = true;
    return {};
  }

 private:
  Enumerator paths_;
  typename Model::State next_;
  std::vector<bool> is_left_out_;
};

}  // namespace aos
