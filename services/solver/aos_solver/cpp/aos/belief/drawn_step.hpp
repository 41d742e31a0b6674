// The update of a belief by drawing. As long as particles have no traces, draws are split (split_filter.hpp). Where too few
// states agree with an observation, or a draw is continuous, the particle filter takes over, whose particles can be moved.
#pragma once

#include "aos/belief/effort.hpp"
#include "aos/belief/history.hpp"
#include "aos/belief/particle_filter.hpp"
#include "aos/belief/split_filter.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"

namespace aos {

inline constexpr std::size_t max_retraced_steps = 30;

// The belief as particles that can be moved: all that has happened since its history began happens to the particles of then.
// Where that leaves none, the history begins with the states as they are.
template <class Model>
Cloud<Model> traced(const Cloud<Model>& before, bool exact, Sampler& random) {
  ParticleFilter<Model> filter{random};
  const auto& steps = before.history.steps();
  if (steps.empty()) return filter.begun(before.particles, exact);
  Cloud<Model> cloud = filter.begun(before.history.rest().origins->particles(), false);
  for (const HistoryStep& step : steps) {
    ++update_effort.traced;
    if (step.numbers == nullptr) {
      cloud = filter.after(std::move(cloud), step, ignored_numbers).cloud;
    } else {
      WeighedNumbers numbers{*step.numbers, true, step.log_scale};
      cloud = filter.after(std::move(cloud), step, numbers).cloud;
    }
    if (cloud.particles.empty()) return filter.begun(before.particles, false);
  }
  return cloud;
}

// Updates a cloud by a step. A cloud without lineages has no history; its weights are `exact`, or worth one sample each. A cloud
// without traces has at most `limit` states. The result has no particles if nothing gave what was observed.
template <class Model>
UpdatedCloud<Model> drawn_step(Cloud<Model> before, bool exact, const HistoryStep& step, NumberSink& numbers, std::size_t limit,
                               Sampler& random) {
  ParticleFilter<Model> filter{random};
  if (before.has_traces()) return filter.after(std::move(before), step, numbers);
  if (before.lineages.empty()) {
    before.history = History<Model>{before.particles};
    for (const auto& [state, weight] : before.particles) before.lineages.push_back({exact ? 0 : weight * weight, nullptr});
  } else if (before.history.steps().size() >= max_retraced_steps) {
    before.history = History<Model>{before.particles};
  }
  UpdatedCloud<Model> split{{}, 0};
  try {
    split = split_step(before, step, numbers, limit, random);
    if (!step.is_observed || split.cloud.effective() >= too_few_effective) return split;
  } catch (const NotEnumerable&) {
  }
  UpdatedCloud<Model> moved = filter.after(traced(before, exact, random), step, numbers);
  return moved.cloud.effective() >= split.cloud.effective() ? std::move(moved) : std::move(split);
}

}
