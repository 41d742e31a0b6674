// Whether the actions can lead from a belief to a goal.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/belief/history.hpp"
#include "aos/child/reachability.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

// States that have ended already do not count. If not all states can be listed, random walks look for a goal. `seconds` are of
// processor time, for the list and for the walks.
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
