// The outcomes of an action from weighted states, if steps can be enumerated.
#pragma once

#include "aos/belief/gathering.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/step.hpp"

namespace aos {

// Calls `visit(before, next, observation, weight)` for nearly every outcome of an action. Returns the weight
// of the others. `numbers` takes the numbers that steps report. Throws NotEnumerable if a step cannot be
// enumerated, or if there are more than `max_paths` paths, which the states so far often tell.
template <class Model, class Visit>
double enumerate_outcomes(const List<Particle<Model>>& particles, int action, NumberSink& numbers,
                          std::size_t max_paths, Visit&& visit) {
  constexpr std::size_t telling = 64;
  Enumerator draws;
  draws.report_to(&numbers);
  std::size_t paths = 0;
  std::size_t states = 0;
  double left_out = 0;
  typename Model::State next{};
  Step step;
  for (const auto& particle : particles) {
    const auto run = [&](Enumerator& path) {
      if (++paths > max_paths) throw NotEnumerable{"too many outcomes"};
      next = particle.state;
      step = Model::step(next, action, path);
    };
    left_out += particle.weight * draws.for_nearly_each_path(run, [&](Enumerator& path) {
      visit(particle.state, next, step.observation, particle.weight * path.probability());
    });
    if (++states % telling == 0 && paths / states > 2 * max_paths / particles.size()) {
      throw NotEnumerable{"too many outcomes"};
    }
  }
  return left_out;
}

}
