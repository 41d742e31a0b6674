// Which states the actions can reach: every outcome of every action, breadth first, whatever its probability.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

// Once it has found a goal and met the precondition of every action, the search goes on only as far as `later_limits`
// allow: code may fail behind the first goal, too. Where only the goal matters, no precondition is looked at, and the search ends
// with the goal.
template <class Model>
class Reachability {
 public:
  // `seconds` are of processor time.
  Reachability(const Belief<Model>& belief, double seconds, bool only_goal = false)
      : unmet_(only_goal ? 0 : Model::action_count()), is_met_(Model::action_count(), only_goal) {
    const auto latest = processor_time() + std::chrono::duration<double>{seconds};
    try {
      if (!only_goal && !belief.is_exact()) throw NotEnumerable{"the initial belief is only known by samples"};
      space_.reach_within(belief, 0);
      while (look(), !space_.is_closed() && !(only_goal && has_goal())) {
        if (is_done()) space_.limit(later_limits);
        if (processor_time() > latest) throw NotEnumerable{"it takes longer than allowed"};
        const std::size_t known = space_.size();
        space_.reach_within(belief, 1);
        if (space_.size() > known) ++depth_;
      }
    } catch (const NotEnumerable& limit) {
      blame::at(0);
      if (!is_done()) limit_ = limit.reason;
    }
  }

  bool has_goal() const { return space_.reaches(Ending::goal); }
  bool is_met(int action) const { return is_met_[action]; }
  std::size_t states() const { return space_.size(); }
  int depth() const { return depth_; }
  // Why the search may have missed a goal or a precondition that can be met; empty if it has not.
  const char* limit() const { return limit_; }
  // Whether it saw every state.
  bool is_whole() const { return space_.is_closed(); }

 private:
  bool is_done() const { return has_goal() && unmet_ == 0; }

  // Evaluates preconditions in the new states.
  void look() {
    for (; looked_at_ < space_.size(); ++looked_at_) {
      for (int action = 0; action < Model::action_count(); ++action) {
        if (!is_met(action)) try_precondition(looked_at_, action);
      }
    }
  }

  void try_precondition(std::uint32_t number, int action) {
    bool meets = false;
    bool meets_now = false;
    draws_.for_each_path(
        [&](Enumerator& path) { meets_now = Model::meets_precondition(space_[number], action, path); },
        [&](Enumerator&) { meets = meets || meets_now; });
    if (!meets) return;
    is_met_[action] = true;
    --unmet_;
  }

  StateSpace<Model> space_{{.states = 100'000, .bytes = std::size_t{256} << 20}};
  std::size_t unmet_;
  std::vector<bool> is_met_;
  std::uint32_t looked_at_ = 0;
  int depth_ = 0;
  const char* limit_ = "";
  Enumerator draws_;
};

// Whether the actions can lead from a belief to a goal. States that have ended already do not count. If not all states can be
// listed, random walks look for a goal. `seconds` are of processor time, for the list and for the walks.
template <class Model>
bool can_reach_goal(const Belief<Model>& belief, double seconds, int horizon, Sampler& random) {
  List<Particle<Model>> running;
  for (const auto& particle : belief.particles()) {
    if (Model::ending(particle.state) == Ending::running) running.push_back(particle);
  }
  if (running.empty()) return false;
  const auto of_running = Belief<Model>::of(Cloud<Model>{running, {}, {}}, belief.error_bound(), belief.is_drawn());
  const Reachability<Model> reached{of_running, seconds, /*only_goal=*/true};
  if (reached.has_goal() || reached.is_whole()) return reached.has_goal();
  constexpr std::size_t max_walks = 2000;
  const auto latest = processor_time() + std::chrono::duration<double>{seconds};
  RandomWalk<Model> walk;
  bool is_reachable = false;
  draw_evenly<Model>(running, max_walks, random, [&](typename Model::State state) {
    if (is_reachable || processor_time() > latest) return;
    walk.take(state, horizon, random);
    is_reachable = Model::ending(state) == Ending::goal;
  });
  return is_reachable;
}

}
