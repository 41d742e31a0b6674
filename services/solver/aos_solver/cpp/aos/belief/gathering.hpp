// Distinct states with weights, collected one by one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/base/function_ref.hpp"
#include "aos/base/number_index.hpp"
#include "aos/base/random.hpp"

namespace aos {

template <class Model>
struct Particle {
  typename Model::State state;
  double weight;
};

// Calls `visit(state)` for states at even distances in the cumulative weights, from a random start (systematic sampling).
template <class Model>
void draw_evenly(const std::vector<Particle<Model>>& particles, std::size_t count, Sampler& random,
                 FunctionRef<void(const typename Model::State&)> visit) {
  double total = 0;
  for (const auto& particle : particles) total += particle.weight;
  const double distance = total / static_cast<double>(count);
  double position = random.uniform() * distance;
  std::size_t number = 0;
  for (std::size_t i = 0; i < count; ++i, position += distance) {
    while (position >= particles[number].weight && number + 1 < particles.size()) position -= particles[number++].weight;
    visit(particles[number].state);
  }
}

// The weight c for which min(weight / c, 1) sums to `count` over all weights. There are more than `count` weights.
inline double common_weight(std::vector<double> weights, std::size_t count) {
  std::sort(weights.begin(), weights.end());
  double light = 0;  // the sum of the lightest so far
  std::size_t heavy = weights.size();
  for (const double weight : weights) {
    if (heavy < count && weight * static_cast<double>(count - heavy) >= light) break;
    light += weight;
    --heavy;
  }
  return light / static_cast<double>(count - heavy);
}

// Leaves at most `count` weights and sets the others to 0; no weight's mean changes (Fearnhead and Clifford,
// 2003). Heavy weights stay as they are. Some of the light ones are drawn and get the same weight. Returns
// the sum of the others, which is the total variation distance to the weights before, in their unit.
inline double thin_out(std::vector<double>& weights, std::size_t count, Sampler& random) {
  if (weights.size() <= count) return 0;
  const double common = common_weight(weights, count);
  double gone = 0;
  double drawn = random.uniform() * common;
  for (double& weight : weights) {
    if (weight >= common) continue;
    if ((drawn -= weight) < 0) {
      weight = common;
      drawn += common;
    } else {
      gone += weight;
      weight = 0;
    }
  }
  return gone;
}

// Merges equal states. Their order is that of first appearance, so that results do not depend on hashing.
template <class Model>
class Gathering {
 public:
  using State = typename Model::State;

  // Returns the number of the state's particle.
  std::size_t add(const State& state, double weight) {
    const auto is_it = [&](std::uint32_t number) { return particles_[number].state == state; };
    const std::size_t number = numbers_.find_or_add(Model::hash(state), static_cast<std::uint32_t>(particles_.size()), is_it);
    if (number == particles_.size()) {
      particles_.push_back({state, weight});
    } else {
      particles_[number].weight += weight;
    }
    return number;
  }

  void clear() {
    numbers_ = {};
    particles_.clear();
  }

  std::size_t size() const { return particles_.size(); }
  const std::vector<Particle<Model>>& particles() const { return particles_; }
  double total() const {
    double sum = 0;
    for (const auto& particle : particles_) sum += particle.weight;
    return sum;
  }

  // Leaves at most `count` states. Returns the weight of those that were dropped.
  double reduce(std::size_t count, Sampler& random) {
    if (particles_.size() <= count) return 0;
    std::vector<double> weights;
    for (const auto& particle : particles_) weights.push_back(particle.weight);
    const double gone = thin_out(weights, count, random);
    std::vector<Particle<Model>> all;
    all.swap(particles_);
    clear();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] > 0) add(all[i].state, weights[i]);
    }
    return gone;
  }

 private:
  NumberIndex numbers_;
  std::vector<Particle<Model>> particles_;
};

}  // namespace aos
