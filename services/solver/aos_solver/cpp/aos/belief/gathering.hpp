// Distinct states with weights, as they come in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/base/random.hpp"

namespace aos {

template <class Model>
struct Particle {
  typename Model::State state;
  double weight;
};

// Calls `visit(state)` for states at even distances in the cumulative weights, from a random start (systematic sampling).
template <class Model, class Visit>
void draw_evenly(const std::vector<Particle<Model>>& particles, std::size_t count, Sampler& random, Visit&& visit) {
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

// Merges equal states; the order of first appearance is kept, so that results do not depend on hashing.
template <class Model>
class Gathering {
 public:
  using State = typename Model::State;

  void add(const State& state, double weight) {
    if (2 * particles_.size() >= places_.size()) grow();
    const std::uint64_t hash = Model::hash(state);
    std::size_t place = hash & (places_.size() - 1);
    for (; places_[place].number != none; place = (place + 1) & (places_.size() - 1)) {
      if (places_[place].hash != hash || !(particles_[places_[place].number].state == state)) continue;
      particles_[places_[place].number].weight += weight;
      return;
    }
    places_[place] = {hash, static_cast<std::uint32_t>(particles_.size())};
    particles_.push_back({state, weight});
  }

  void clear() {
    places_.clear();
    particles_.clear();
  }

  std::size_t size() const { return particles_.size(); }
  const std::vector<Particle<Model>>& particles() const { return particles_; }
  double total() const {
    double sum = 0;
    for (const auto& particle : particles_) sum += particle.weight;
    return sum;
  }

  // Leaves at most `most` states without changing any state's expected weight (Fearnhead and Clifford, 2003): heavy ones
  // stay as they are, of the light ones some are drawn and get the same weight. Returns the weight of those that went,
  // which is the total variation distance to what was there, in its unit.
  double reduce(std::size_t most, Sampler& random) {
    if (particles_.size() <= most) return 0;
    const double common = common_weight(most);
    double gone = 0;
    double drawn = random.uniform() * common;
    std::vector<Particle<Model>> kept;
    kept.reserve(most + 1);
    for (const auto& particle : particles_) {
      if (particle.weight >= common) {
        kept.push_back(particle);
      } else if ((drawn -= particle.weight) < 0) {
        kept.push_back({particle.state, common});
        drawn += common;
      } else {
        gone += particle.weight;
      }
    }
    clear();
    for (const auto& particle : kept) add(particle.state, particle.weight);
    return gone;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Place {
    std::uint64_t hash = 0;
    std::uint32_t number = none;
  };

  // Open addressing, at most half full.
  void grow() {
    std::vector<Place> old(std::max<std::size_t>(2 * places_.size(), 64));
    old.swap(places_);
    for (const Place& entry : old) {
      if (entry.number == none) continue;
      std::size_t place = entry.hash & (places_.size() - 1);
      while (places_[place].number != none) place = (place + 1) & (places_.size() - 1);
      places_[place] = entry;
    }
  }

  // The weight c with which the sum of min(weight / c, 1) over all states is `most`.
  double common_weight(std::size_t most) const {
    std::vector<double> weights;
    for (const auto& particle : particles_) weights.push_back(particle.weight);
    std::sort(weights.begin(), weights.end());
    double light = 0;  // of the lightest so far
    std::size_t heavy = weights.size();
    for (const double weight : weights) {
      if (heavy < most && weight * static_cast<double>(most - heavy) >= light) break;
      light += weight;
      --heavy;
    }
    return light / static_cast<double>(most - heavy);
  }

  std::vector<Place> places_;
  std::vector<Particle<Model>> particles_;
};

}  // namespace aos
