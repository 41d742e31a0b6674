// The expected reward of a step, where its outcomes are few. A search that draws rewards learns of a loss of 100,000 with a
// probability of 1e-4 from one simulation in 10,000. So the rewards of a simulation's first steps count by their expectation, and
// what is left to chance is the next state (a Rao-Blackwell estimate). The second step does, too: the search keeps what is below.
#pragma once

#include "aos/planning/values/few_outcomes.hpp"

namespace aos {

template <class Model>
class ExpectedRewards {
 public:
  ExpectedRewards() {
    for (int action = 0; action < Model::action_count(); ++action) {
      if (Model::has_certain_rewards(Model::skill_of(action))) outcomes_.leave_out(action);
    }
  }

  // Nothing if the reward is certain, or if the action's outcomes are not few.
  std::optional<double> of(const typename Model::State& state, int action) {
    double sum = 0;
    const auto add = [&](const typename Model::State&, const Step& step, double probability) { sum += step.reward * probability; };
    return outcomes_.visit_each(state, action, add) ? std::optional{sum} : std::nullopt;
  }

 private:
  FewOutcomes<Model> outcomes_;
};

}
