// The probability that a step violates the mission's constraints.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/violations.hpp"

namespace aos {

// The violations of one step. A mission that is over violates nothing.
template <class Model>
Violations violations_of(const typename Model::State& before, const typename Model::State& next, int action) {
  if (Model::constraint_count() == 0 || Model::ending(before) != Ending::running) return 0;
  return Model::violations(before, next, action);
}

// The probabilities by constraint. Steps that cannot be enumerated are sampled.
struct Risks {
  List<double> probabilities;
  bool is_sampled = false;
};

inline constexpr int risk_samples = 20'000;

// The risks of an action under a belief. Outcomes that an enumeration leaves out count as violations.
template <class Model>
Risks risks_of(const Belief<Model>& belief, int action, std::size_t max_paths, Sampler& random) {
  using State = typename Model::State;
  const std::size_t count = Model::constraint_count();
  Risks risks{List<double>(count)};
  const auto add = [&](const State& before, const State& next, double weight) {
    const Violations violations = violations_of<Model>(before, next, action);
    for (std::size_t i = 0; i < count; ++i) {
      if ((violations >> i & 1) != 0) risks.probabilities[i] += weight;
    }
  };
  if (!Model::constraints_look_ahead()) {
    for (const auto& [state, weight] : belief.particles()) add(state, state, weight);
    return risks;
  }
  try {
    const double left_out = enumerate_outcomes<Model>(
        belief.particles(), action, ignored_numbers, max_paths,
        [&](const State& before, const State& next, Observation, double weight) { add(before, next, weight); });
    for (double& probability : risks.probabilities) probability += left_out;
  } catch (const NotEnumerable&) {
    risks = {List<double>(count), true};
    for (int i = 0; i < risk_samples; ++i) {
      const State before = belief.sample(random);
      State next = before;
      Model::step(next, action, random);
      add(before, next, 1.0 / risk_samples);
    }
  }
  return risks;
}

}
