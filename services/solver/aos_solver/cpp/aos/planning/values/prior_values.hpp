// Draws the values of a search towards a prior, unless the search shows that the prior is wrong: empirical Bayes (Efron and
// Morris, 1973). The prior ranks actions by values of states and has no noise. Its error is estimated from the distances between
// values and prior, beyond what the values' standard errors explain. The larger this error is, the more the values count.
#pragma once

#include "aos/planning/budget.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/values/learned_values.hpp"
#include "aos/planning/values/mdp_values.hpp"

namespace aos {

// Makes a prior: how much less each action is worth than the best one.
inline List<double> below_best(List<double> worths) {
  const double best = *std::max_element(worths.begin(), worths.end());
  for (double& worth : worths) worth = best - worth;
  return worths;
}

// The prior by learned values of the next states, on average over some states of the belief and with the same
// luck for all actions (QMDP: Littman, Cassandra and Kaelbling, 1995).
template <class Model>
List<double> learned_prior(const LearnedValues<Model>& values, const Belief<Model>& belief, int horizon,
                                  Sampler& random) {
  List<double> worths(Model::action_count());
  const auto states = std::clamp<std::size_t>(max_prior_steps / worths.size(), 20, 500);
  for (std::size_t i = 0; i < states; ++i) {
    const typename Model::State& state = belief.sample(random);
    const Sampler luck{random.bits()};
    if (Model::ending(state) != Ending::running) continue;
    for (int a = 0; a < Model::action_count(); ++a) worths[a] += values.stepped_value(state, a, horizon, luck) / states;
  }
  return below_best(std::move(worths));
}

template <class Model>
List<double> listed_prior(const MdpValues<Model>& values, const StateSpace<Model>& space, const Belief<Model>& belief) {
  List<double> worths(Model::action_count());
  for (const auto& [number, weight] : space.weights_of(belief)) values.add_action_values(number, worths, weight);
  return below_best(std::move(worths));
}

// Draws estimates towards a prior in their unit. `counts(estimate)` tells which actions were searched for
// long enough; the others get the value of the prior.
void draw_towards(const List<double>& prior, Estimates& estimates, auto&& counts) {
  double sum = 0;
  double count = 0;
  for (std::size_t a = 0; a < prior.size(); ++a) {
    if (!counts(estimates[a])) continue;
    sum += estimates[a].q + prior[a];
    ++count;
  }
  if (count == 0) return;
  const double level = sum / count;  // the best action's value by the prior
  double unexplained = 0;
  for (std::size_t a = 0; a < prior.size(); ++a) {
    const double distance = estimates[a].q - (level - prior[a]);
    if (counts(estimates[a])) unexplained += distance * distance - estimates[a].standard_error * estimates[a].standard_error;
  }
  const double spread = std::max(unexplained / std::max(count - 1, 1.0), 0.0);  // variance of the prior's errors
  for (std::size_t a = 0; a < prior.size(); ++a) {
    const double error = estimates[a].standard_error * estimates[a].standard_error;
    const double share = counts(estimates[a]) && spread > 0 ? spread / (spread + error) : 0;
    estimates[a].q = share * estimates[a].q + (1 - share) * (level - prior[a]);
  }
}

}
