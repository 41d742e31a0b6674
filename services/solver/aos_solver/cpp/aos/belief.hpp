// A belief: distinct states with weights that sum to 1, and Bayes' rule on it.
//
// While steps can be enumerated the update is exact: every outcome of every state, equal states merged, no sampling and
// so no depletion. Where they cannot, or where the states become too many, it is a particle filter by rejection.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/enumerator.hpp"
#include "aos/json.hpp"
#include "aos/random.hpp"
#include "aos/reflection.hpp"
#include "aos/step.hpp"

namespace aos {

inline constexpr std::size_t particle_count = 5000;
inline constexpr std::size_t most_exact_states = 200'000;
inline constexpr std::size_t most_enumerated_paths = 4'000'000;  // of one update
inline constexpr std::size_t most_trials = 100 * particle_count;
inline constexpr double negligible_weight = 1e-12;

// What the belief becomes when the model holds an observation impossible.
enum class ImpossiblePolicy { hold, widen, reset };

using ObservationOdds = std::vector<std::pair<Observation, double>>;

template <class Model>
class Belief {
 public:
  using State = typename Model::State;
  struct Particle {
    State state;
    double weight;
  };

  const std::vector<Particle>& particles() const { return particles_; }
  bool is_exact() const { return is_exact_; }

  static Belief initial(Sampler& random) {
    try {
      Gathering gathering;
      Enumerator{}.for_each_path([&](Enumerator& draws) {
        State state{};
        Model::initial(state, draws);
        gathering.add(state, draws.probability());
      });
      return gathering.belief(true);
    } catch (const NotEnumerable&) {
      Gathering gathering;
      for (std::size_t i = 0; i < particle_count; ++i) {
        State state{};
        Model::initial(state, random);
        gathering.add(state, 1.0 / particle_count);
      }
      return gathering.belief(false);
    }
  }

  // After an action, before any observation.
  Belief predicted(int action, Sampler& random) const {
    Gathering gathering;
    const Walk walk = for_each_outcome(action, random, gathering.reset(), [&](const State& next, Observation, double weight) {
      gathering.add(next, weight);
      return true;
    });
    return gathering.belief(walk.is_exact && is_exact_);
  }

  // How likely each observation is after an action, the likeliest first.
  ObservationOdds observations(int action, Sampler& random) const {
    std::unordered_map<Observation, double> odds;
    const Walk walk =
        for_each_outcome(action, random, [&] { odds.clear(); }, [&](const State&, Observation observation, double weight) {
          odds[observation] += weight;
          return true;
        });
    ObservationOdds sorted(odds.begin(), odds.end());
    for (auto& [observation, probability] : sorted) probability /= walk.weight;
    std::sort(sorted.begin(), sorted.end(), [](const auto& left, const auto& right) {
      return left.second != right.second ? left.second > right.second : left.first < right.first;
    });
    return sorted;
  }

  // The posterior and the probability of the observation; an empty belief and 0 where that is impossible.
  std::pair<Belief, double> posterior(int action, Observation observation, Sampler& random) const {
    Gathering gathering;
    const Walk walk =
        for_each_outcome(action, random, gathering.reset(), [&](const State& next, Observation seen, double weight) {
          if (seen == observation) gathering.add(next, weight);
          return seen == observation;
        });
    return {gathering.belief(walk.is_exact && is_exact_), gathering.total() / walk.weight};
  }

  // `share` of `other` and the rest of this one.
  Belief mixed_with(const Belief& other, double share) const {
    Gathering gathering;
    for (const auto& [state, weight] : particles_) gathering.add(state, weight * (1 - share));
    for (const auto& [state, weight] : other.particles_) gathering.add(state, weight * share);
    return gathering.belief(is_exact_ && other.is_exact_);
  }

  const State& sample(Sampler& random) const {
    const double drawn = random.uniform() * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), drawn);
    const auto index = std::min<std::size_t>(found - cumulative_.begin(), particles_.size() - 1);
    return particles_[index].state;
  }

  double probability_of(Ending ending) const {
    double sum = 0;
    for (const auto& [state, weight] : particles_) sum += Model::ending(state) == ending ? weight : 0;
    return sum;
  }

  // In nats.
  double entropy() const {
    double sum = 0;
    for (const auto& particle : particles_) sum -= particle.weight * std::log(particle.weight);
    return std::max(sum, 0.0);
  }

  void write_summary(JsonWriter& json) const {
    json.begin_object().key("marginals").begin_array();
    for (const auto& [variable, values] : marginals()) {
      json.begin_object().member("variable", variable).key("values").begin_object();
      for (const auto& [value, probability] : values) json.member(value, probability);
      json.end_object().end_object();
    }
    json.end_array().member("entropy", entropy());
    json.member("goal_probability", probability_of(Ending::goal));
    json.member("failure_probability", probability_of(Ending::failure));
    json.member("states", particles_.size()).member("is_exact", is_exact_).end_object();
  }

  static Belief of(const std::vector<Particle>& particles, bool is_exact) {
    Gathering gathering;
    for (const auto& [state, weight] : particles) gathering.add(state, weight);
    return gathering.belief(is_exact);
  }

 private:
  struct Hash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };

  // Merges equal states; the order of first appearance is kept, so that results do not depend on hashing.
  class Gathering {
   public:
    void add(const State& state, double weight) {
      const auto [entry, is_new] = index_.try_emplace(state, particles_.size());
      if (is_new) particles_.push_back({state, 0});
      particles_[entry->second].weight += weight;
    }
    // Forgets everything.
    auto reset() {
      return [this] { *this = {}; };
    }
    double total() const {
      double sum = 0;
      for (const auto& particle : particles_) sum += particle.weight;
      return sum;
    }
    Belief belief(bool is_exact) const {
      Belief belief;
      belief.is_exact_ = is_exact;
      const double sum = total();
      for (const auto& [state, weight] : particles_) {
        if (weight <= negligible_weight * sum) continue;
        belief.particles_.push_back({state, weight / sum});
        belief.cumulative_.push_back((belief.cumulative_.empty() ? 0 : belief.cumulative_.back()) + weight / sum);
      }
      return belief;
    }

   private:
    std::unordered_map<State, std::size_t, Hash> index_;
    std::vector<Particle> particles_;
  };

  struct Walk {
    bool is_exact;
    double weight;  // of all outcomes, visited ones and others
  };

  // Calls `visit(next, observation, weight)`, which says whether it has a use for the outcome: for all outcomes, by
  // enumeration; or else, after `restart()`, for drawn ones until `particle_count` were of use.
  template <class Restart, class Visit>
  Walk for_each_outcome(int action, Sampler& random, Restart&& restart, Visit&& visit) const {
    try {
      if (particles_.size() > most_exact_states) throw NotEnumerable{"too many states"};
      Enumerator draws;
      std::size_t paths = 0;
      for (const auto& [state, weight] : particles_) {
        draws.for_each_path([&](Enumerator& path) {
          if (++paths > most_enumerated_paths) throw NotEnumerable{"too many outcomes"};
          State next = state;
          const Step step = Model::step(next, action, path);
          visit(next, step.observation, weight * path.probability());
        });
      }
      return {true, 1};
    } catch (const NotEnumerable&) {
      restart();
    }
    std::size_t used = 0;
    std::size_t trials = 0;
    while (trials < most_trials && used < particle_count) {
      State next = sample(random);
      const Step step = Model::step(next, action, random);
      used += visit(next, step.observation, 1.0) ? 1 : 0;
      ++trials;
    }
    return {false, static_cast<double>(trials)};
  }

  using Marginal = std::pair<std::string, std::vector<std::pair<std::string, double>>>;

  std::vector<Marginal> marginals() const {
    std::vector<Marginal> result;
    std::unordered_map<std::string, std::size_t> index;
    for (const auto& [state, state_weight] : particles_) {
      const double weight = state_weight;
      Model::visit(state, [&](const std::string& name, const auto& leaf) {
        const auto [entry, is_new] = index.try_emplace(name, result.size());
        if (is_new) result.push_back({name, {}});
        auto& values = result[entry->second].second;
        const std::string text = leaf_text(leaf);
        const auto known = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == text; });
        if (known == values.end()) {
          values.push_back({text, weight});
        } else {
          known->second += weight;
        }
      });
    }
    for (auto& [variable, values] : result) {
      std::stable_sort(values.begin(), values.end(),
                       [](const auto& left, const auto& right) { return left.second > right.second; });
    }
    return result;
  }

  std::vector<Particle> particles_;
  std::vector<double> cumulative_;
  bool is_exact_ = true;
};

}  // namespace aos
