// All outcomes of an action in a state, where they are few, and the reward that they give on average.
#pragma once

#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"

namespace aos {

template <class Model>
class FewOutcomes {
 public:
  FewOutcomes() : is_left_out_(Model::action_count()) { paths_.report_to(&ignored_numbers); }

  void leave_out(int action) { is_left_out_[action] = true; }

  // Calls `visit(next state, step, probability)` for each outcome. False if the action is left out, as it is once it has had too
  // many outcomes, or a continuous draw that does not count by its mean; some outcomes may have been visited then.
  bool visit_each(const typename Model::State& state, int action, auto&& visit) {
    if (is_left_out_[action]) return false;
    const bool are_few = comes_to_an_end([&] { walk(state, action, visit); });
    if (!are_few) leave_out(action);
    return are_few;
  }
  // The same, and throws what a step throws, or NotEnumerable.
  void walk(const typename Model::State& state, int action, auto&& visit) {
    Step step;
    const auto run = [&](Enumerator& path) {
      next_ = state;
      step = Model::step(next_, action, path);
    };
    paths_.for_nearly_each_path(run, [&](Enumerator& path) { visit(next_, step, path.probability()); }, max_reward_paths);
  }

 private:
  Enumerator paths_;
  typename Model::State next_;
  std::vector<bool> is_left_out_;
};

// The expected reward of a step. A search that draws rewards learns of a loss of 100,000 with a probability of 1e-4 from one
// simulation in 10,000. So the rewards of a simulation's first steps count by their expectation, and what is left to chance is the next
// state (a Rao-Blackwell estimate). The second step does, too: the search keeps what is below.
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
