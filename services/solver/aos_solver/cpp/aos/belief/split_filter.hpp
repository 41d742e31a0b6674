// The update of a belief whose steps have too many outcomes to list, by draws that split (split_draws.hpp): paths of heavy states
// are enumerated, those of light ones are drawn, equal states are merged, and the lightest are thinned out (Fearnhead and
// Clifford, 2003). Nothing is moved: where an observation leaves too few, particle_filter.hpp takes over. All limits are numbers
// of draws and paths, so that the same seed gives the same belief.
#pragma once

#include "aos/belief/effort.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/history.hpp"
#include "aos/draws/split_draws.hpp"

namespace aos {

inline constexpr double split_paths = 200'000;             // of one update, about
inline constexpr std::size_t max_split_work = 4'000'000;  // in draws; after as many, less is split

// The belief after a step; it has at most `limit` states, and its lineages have no traces. Throws NotEnumerable for a continuous
// draw.
template <class Model>
UpdatedCloud<Model> split_step(const Cloud<Model>& before, const HistoryStep& step, NumberSink& numbers, std::size_t limit,
                               Sampler& random) {
  SplitDraws draws{random};
  draws.report_to(&numbers);
  GatheredCloud<Model> gathered;
  double threshold = before.total() / split_paths;
  std::size_t work = 0;
  std::size_t most_work = max_split_work;
  for (std::size_t i = 0; i < before.particles.size(); ++i) {
    const auto& [state, weight] = before.particles[i];
    const double squares = before.lineages[i].squares / weight / weight;
    draws.start(weight, threshold);
    do {
      auto next = state;
      ++update_effort.steps;
      const Step done = Model::step(next, step.action, draws);
      work += work_of_step(draws, Model::state_bytes());
      const double after = draws.weight();
      if (after <= 0 || !step.agrees(done)) continue;
      // Squares are relative to that of the weight: what is drawn is worth one sample.
      gathered.add(next, after, after * after * (draws.is_certain() ? squares : 1), nullptr, random);
      if (gathered.size() > 2 * limit) gathered.reduce(limit, random);
    } while (draws.advance());
    if (work > most_work) {
      threshold *= 4;
      most_work += max_split_work / 4;
    }
  }
  // How many states the next update can afford, if they are as much work as these.
  const double share = 2.0 * max_split_work / work;
  const auto affordable = static_cast<std::size_t>(share * static_cast<double>(before.particles.size()));
  return gathered.updated(before, step, std::clamp(affordable, std::min(particle_count, limit), limit), random);
}

}
