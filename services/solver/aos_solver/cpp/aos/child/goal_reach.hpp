// Whether the actions can lead from a belief to a goal.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/belief/history.hpp"
#include "aos/child/reachability.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

// States that have ended already do not count. If not all states can be listed, random walks look for a goal.
template <class Model>
class GoalReach {
 public:
  using State = typename Model::State;

  // `seconds` are of processor time, for the list and for the walks.
  GoalReach(const Belief<Model>& belief, double seconds, int horizon, Sampler& random) {
    List<Particle<Model>> running;
    for (const auto& particle : belief.particles()) {
      if (Model::ending(particle.state) == Ending::running) running.push_back(particle);
    }
    if (running.empty()) return;
    const auto of_running = Belief<Model>::of(Cloud<Model>{running, {}, {}}, belief.error_bound(), belief.is_drawn());
    const Reachability<Model> reached{of_running, seconds, /*only_goal=*/true};
    is_reachable_ = reached.has_goal();
    if (!is_reachable_ && !reached.is_whole()) walk(running, seconds, horizon, random);
  }

  bool is_reachable() const { return is_reachable_; }

 private:
  void walk(const List<Particle<Model>>& running, double seconds, int horizon, Sampler& random) {
    constexpr std::size_t max_walks = 2000;
    const auto latest = processor_time() + std::chrono::duration<double>{seconds};
    RandomWalk<Model> walk;
    draw_evenly<Model>(running, max_walks, random, [&](State state) {
      if (is_reachable_ || processor_time() > latest) return;
      walk.take(state, horizon, random);
      is_reachable_ = Model::ending(state) == Ending::goal;
    });
  }

  bool is_reachable_ = false;
};

}
