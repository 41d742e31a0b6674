// All that can be observed where the same is observed several times, if that is little.
#pragma once

#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

class RepeatedObservation {
 public:
  // `reports` are by state.
  explicit RepeatedObservation(const List<StepReports>& reports) {
    for (const Observation response : few_responses(reports)) {
      List<double>& likelihoods = likelihoods_.emplace_back();
      for (const StepReports& report : reports) likelihoods.push_back(report.likelihood({response, {}}));
    }
  }

  // What is observed in a row of steps, [step][state], if it is observed at the last of them only; else none is listed.
  static RepeatedObservation at_last(const List<List<StepReports>>& steps) {
    const bool is_at_last = std::all_of(steps.begin(), steps.end() - 1, [](const auto& step) { return RepeatedObservation{step}.tells_nothing(); });
    return RepeatedObservation{is_at_last ? steps.back() : List<StepReports>{}};
  }

  // Whether all combinations of so many observations can be gone through.
  bool is_listed(int times) const {
    double combinations = 1;  // how often each response comes, in whatever order
    for (std::size_t i = 1; i < likelihoods_.size(); ++i) combinations *= static_cast<double>(times + static_cast<int>(i)) / static_cast<double>(i);
    return !likelihoods_.empty() && combinations <= most_combinations;
  }
  const List<List<double>>& likelihoods() const { return likelihoods_; }
  bool tells_nothing() const { return likelihoods_.size() == 1; }

  // Calls `use(probability, weights)` with the weights after each combination.
  void for_each(const StateWeights& weights, int times, auto&& use) const { follow(0, times, weights, use); }

 private:
  static constexpr double most_combinations = 64;

  // `weights` have the probability of what was observed so far, in each of its orders.
  void follow(std::size_t response, int left, const StateWeights& weights, auto& use) const {
    const bool is_last = response + 1 == likelihoods_.size();
    StateWeights now = weights;
    for (int count = 0; count <= left; ++count) {
      if (count > 0) {
        // The orders grow from (left over count - 1) to (left over count).
        const double orders = static_cast<double>(left - count + 1) / count;
        for (std::size_t k = 0; k < now.size(); ++k) now[k] *= orders * likelihoods_[response][k];
      }
      if (is_last && count < left) continue;
      if (!is_last) {
        follow(response + 1, left - count, now, use);
        continue;
      }
      double sum = 0;
      for (const double weight : now) sum += weight;
      if (!(sum > 0)) continue;
      for (double& weight : now) weight /= sum;
      use(sum, now);
    }
  }

  List<List<double>> likelihoods_;  // [response][state]; empty if they are too many
};

// Calls `use(probability, weights)` with the weights after an observation that is made so many times. Where all that can be observed is too much,
// it is drawn: `see(k, weights)` draws from state k.
void after_each(const RepeatedObservation& observation, int times, const StateWeights& before, Sampler& random, auto&& see, auto&& use) {
  if (observation.is_listed(times)) return observation.for_each(before, times, use);
  draw_states(before, drawn_observations, random, [&](std::size_t k) {
    StateWeights weights = before;
    see(k, weights);
    use(1.0 / drawn_observations, weights);
  });
}

}
