// Whether the actions can lead from a belief to a goal.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/history.hpp"
#include "aos/draws/random.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/listed/state_space.hpp"
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
    if (!list(of_running, seconds)) walk(running, seconds, horizon, random);
  }

  bool is_reachable() const { return is_reachable_; }

 private:
  // Returns whether this tells everything.
  bool list(const Belief<Model>& running, double seconds) {
    const auto latest = processor_time() + std::chrono::duration<double>{seconds};
    StateSpace<Model> space{{.states = 100'000, .bytes = std::size_t{256} << 20}};
    try {
      space.reach_within(running, 0);
      while (!space.is_closed() && !space.reaches(Ending::goal)) {
        if (processor_time() > latest) return false;
        space.reach_within(running, 1);
      }
    } catch (const NotEnumerable&) {
      blame::at(0);
      if (!space.reaches(Ending::goal)) return false;
    }
    is_reachable_ = space.reaches(Ending::goal);
    return true;
  }

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
