// What is at stake in a belief of a few states: what the best options earn where each state is seen, and how much of it is
// lost where it is not, which is the regret of not knowing it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/planning/option_gains.hpp"
#include "aos/planning/repeated_observation.hpp"
#include "aos/planning/sampled_belief.hpp"

namespace aos {

// An action, what it promises, and why.
struct OptionCandidate {
  int action;
  double value;
  const char* reason;
};

template <class Model>
class OptionRegret {
 public:
  static constexpr int observations = 16;  // drawn where not all are gone through

  OptionRegret(const SampledBelief<Model>& belief, const OptionGains<Model>& gains) : belief_(belief), gains_(gains) {}

  // Takes the belief and the gains as they are now.
  void begin() {
    seen_.clear();
    for (std::size_t k = 0; k < belief_.size(); ++k) seen_.push_back(gains_.best_in(k));
    value_seen_ = mean(belief_.weights());
    regret_ = after(belief_.weights());
  }
  // Sets the share of the regret that counts.
  void count(double share) { share_ = share; }
  double share() const { return share_; }

  double value_seen(std::size_t state) const { return seen_[state]; }
  double value_seen() const { return value_seen_; }
  double now() const { return regret_; }
  double after(const StateWeights& weights) const { return std::max(mean(weights) - gains_.best(weights), 0.0); }

  // The mean regret after an observation that is made so many times. Where these are too many to list, `see(k, weights)`
  // draws from state k what is observed.
  template <class See>
  double after(const RepeatedObservation& observation, int times, Sampler& random, See&& see) const {
    double sum = 0;
    if (observation.is_listed(times)) {
      observation.for_each(belief_.weights(), times, [&](double probability, const StateWeights& weights) { sum += probability * after(weights); });
      return sum;
    }
    draw_states(belief_.weights(), observations, random, [&](std::size_t k) {
      StateWeights weights = belief_.weights();
      see(k, weights);
      sum += after(weights);
    });
    return sum / observations;
  }

 private:
  double mean(const StateWeights& weights) const {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * seen_[k];
    return sum;
  }

  const SampledBelief<Model>& belief_;
  const OptionGains<Model>& gains_;
  std::vector<double> seen_;  // what the states are worth if they are seen
  double value_seen_ = 0;
  double regret_ = 0;
  double share_ = 1;
};

}  // namespace aos
