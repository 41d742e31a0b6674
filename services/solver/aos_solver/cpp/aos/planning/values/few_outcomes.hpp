// All outcomes of an action in a state, where they are few.
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

}
