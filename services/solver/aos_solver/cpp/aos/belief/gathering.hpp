// Distinct states with weights, collected one by one.
#pragma once

#include "aos/base/function_ref.hpp"
#include "aos/base/number_index.hpp"
#include "aos/draws/random.hpp"

namespace aos {

template <class Model>
struct Particle {
  typename Model::State state;
  double weight;
};

template <class Model>
double total_weight(const List<Particle<Model>>& particles) {
  double sum = 0;
  for (const auto& particle : particles) sum += particle.weight;
  return sum;
}

// The number of the element that covers this share of all weights, whose running sums are given.
inline std::size_t element_at(const List<double>& cumulative, double share) {
  const auto found = std::upper_bound(cumulative.begin(), cumulative.end(), share * cumulative.back());
  return std::min<std::size_t>(found - cumulative.begin(), cumulative.size() - 1);
}

// Calls `visit(state)` for states drawn by their weights, one in each of `count` equal parts of the cumulative weights
// (stratified sampling). Even distances would agree with a pattern in the order of the states.
template <class Model>
void draw_evenly(const List<Particle<Model>>& particles, std::size_t count, Sampler& random,
                 FunctionRef<void(const typename Model::State&)> visit) {
  const double length = total_weight<Model>(particles) / count;
  double below = 0;  // the weight of the particles before `number`
  std::size_t number = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double position = (i + random.uniform()) * length;
    while (position - below >= particles[number].weight && number + 1 < particles.size()) below += particles[number++].weight;
    visit(particles[number].state);
  }
}

// The weight c for which min(weight / c, 1) sums to `count` over all weights. There are more than `count` weights.
inline double common_weight(List<double> weights, std::size_t count) {
  std::sort(weights.begin(), weights.end());
  double light = 0;  // the sum of the lightest so far
  std::size_t heavy = weights.size();
  for (const double weight : weights) {
    if (heavy < count && weight * (count - heavy) >= light) break;
    light += weight;
    --heavy;
  }
  return light / (count - heavy);
}

// Leaves at most `count` weights and sets the others to 0; no weight's mean changes (Fearnhead and Clifford,
// 2003). Heavy weights stay as they are. Some of the light ones are drawn and get the same weight. Returns
// the sum of the others, which is the total variation distance to the weights before, in their unit.
//
// Neighbours contend for their places, two at a time (Srinivasan, 2001; Gerber, Chopin and Whiteley, 2019): one of them drops
// out, or one stays, and the other one goes on with what is left of both. Draws at even distances would agree with a pattern in
// the order of the states: of pairs of equal weights they would leave all first ones, or all second ones.
inline double thin_out(List<double>& weights, std::size_t count, Sampler& random) {
  if (weights.size() <= count) return 0;
  const double common = common_weight(weights, count);
  double gone = 0;
  double* contender = nullptr;
  double chance = 0;  // of the contender
  const auto stays = [&](double& weight) { weight = common; };
  const auto drops = [&](double& weight, double original) {
    gone += original;
    weight = 0;
  };
  double contending = 0;  // the contender's own weight
  for (double& weight : weights) {
    if (weight >= common || weight <= 0) continue;
    const double own = weight;
    const double other = own / common;
    if (contender == nullptr) {
      contender = &weight, chance = other, contending = own;
      continue;
    }
    const double sum = chance + other;
    const bool is_one_left = sum < 1;
    // Whether the new one is the one that is decided on.
    const bool is_new = is_one_left ? random.uniform() * sum < chance : random.uniform() * (2 - sum) >= 1 - other;
    if (is_one_left) {
      is_new ? drops(weight, own) : drops(*contender, contending);
    } else {
      is_new ? stays(weight) : stays(*contender);
    }
    if (!is_new) contender = &weight, contending = own;
    chance = is_one_left ? sum : sum - 1;
  }
  if (contender != nullptr) random.uniform() < chance ? stays(*contender) : drops(*contender, contending);
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
    if (number == particles_.size()) particles_.push_back({state, weight});
    else particles_[number].weight += weight;
    return number;
  }

  void clear() {
    numbers_ = {};
    particles_.clear();
  }

  std::size_t size() const { return particles_.size(); }
  const List<Particle<Model>>& particles() const { return particles_; }
  double total() const { return total_weight<Model>(particles_); }

  // Leaves at most `count` states. Returns the weight of those that were dropped.
  double reduce(std::size_t count, Sampler& random) {
    if (particles_.size() <= count) return 0;
    List<double> weights;
    for (const auto& particle : particles_) weights.push_back(particle.weight);
    const double gone = thin_out(weights, count, random);
    List<Particle<Model>> all;
    all.swap(particles_);
    clear();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] > 0) add(all[i].state, weights[i]);
    }
    return gone;
  }

 private:
  NumberIndex numbers_;
  List<Particle<Model>> particles_;
};

}
