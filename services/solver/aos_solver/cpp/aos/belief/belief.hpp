// A belief: distinct states with weights that sum to 1, and Bayes' rule on it.
//
// While steps can be enumerated the update is exact: every outcome of every state, equal states merged, no sampling and
// so no depletion. Where the states become too many, the heavy ones stay and the light ones are thinned out, and the
// belief bounds how far it may be from the exact one. Where steps cannot be enumerated, it is a particle filter.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/json.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/marginals.hpp"
#include "aos/belief/outcomes.hpp"
#include "aos/model/step.hpp"

namespace aos {

inline constexpr std::size_t most_weighted_states = 100'000;
inline constexpr std::size_t most_weighted_bytes = std::size_t{64} << 20;
inline constexpr int most_initial_paths = 1'000'000;
inline constexpr std::size_t most_enumerated_paths = 4'000'000;  // of one update of an exact belief
inline constexpr std::size_t most_paths_of_particles = 10 * particle_count;  // of one update of any other
inline constexpr double negligible_weight = 1e-12;

// What the belief becomes when the model holds an observation impossible.
enum class ImpossiblePolicy { hold, widen, reset };

using ObservationOdds = std::vector<std::pair<Observation, double>>;

template <class Model>
class Belief {
 public:
  using State = typename Model::State;
  using Particle = aos::Particle<Model>;

  const std::vector<Particle>& particles() const { return particles_; }
  bool is_exact() const { return error_bound_ == 0; }
  // Whether its states were drawn at random.
  bool is_drawn() const { return source_ == Source::drawing; }
  // Of a drawn one; there are none where the initial belief was enumerated.
  const Unobserved<Model>& unobserved() const { return unobserved_; }
  // No event's probability is further than this from the exact belief's; 1 where steps were sampled.
  double error_bound() const { return error_bound_; }
  // How many states of equal weight would tell as much.
  double effective_states() const {
    double squares = 0;
    for (const auto& particle : particles_) squares += particle.weight * particle.weight;
    return squares > 0 ? 1 / squares : 0;
  }

  static Belief initial(Sampler& random) {
    Gathering<Model> gathering;
    State state{};
    Enumerator draws;
    double combinations = 0;
    constexpr int telling = 10;
    for (int i = 0; i < telling; ++i) {
      draws.draw_path(random, [&](Enumerator& path) { Model::initial(state, path); });
      combinations += draws.combinations() / telling;
    }
    if (combinations <= 2 * most_initial_paths) {
      try {
        double gone = 0;
        const std::size_t most = most_states(Source::enumeration);
        const auto add = [&](Enumerator& path) {
          Model::initial(state, path);
          gathering.add(state, path.probability());
          if (gathering.size() > 2 * most) gone += gathering.reduce(most, random);
        };
        draws.for_each_path(add, most_initial_paths);
        gone += gathering.reduce(most, random);
        return Belief{gathering, gone, Source::enumeration};
      } catch (const NotEnumerable&) {
        gathering.clear();
      }
    }
    Unobserved<Model> unobserved;
    for (std::size_t i = 0; i < particle_count; ++i) {
      Model::initial(state, random);
      gathering.add(state, 1.0);
      unobserved.add(state);
    }
    Belief belief{gathering, 1, Source::drawing};
    belief.unobserved_ = std::move(unobserved);
    return belief;
  }

  // After an action, before any observation.
  Belief predicted(int action, Sampler& random) const {
    return gathered(action, ignored_numbers, random, [](Observation) { return true; }).first;
  }

  // How likely each response is after an action, whatever numbers come with it; the likeliest first.
  ObservationOdds observations(int action, Sampler& random) const {
    std::unordered_map<Observation, double> odds;
    const auto add = [&](const State&, Observation observation, double weight) {
      odds[observation] += weight;
      return true;
    };
    double total = 1;
    try {
      enumerate_outcomes<Model>(particles_, action, ignored_numbers, most_paths(), add);
    } catch (const NotEnumerable&) {
      odds.clear();
      total = DrawnOutcomes<Model>{particles_, unobserved_, is_thin(), action, ignored_numbers, random}.draw(
          add, [&] { odds.clear(); });
    }
    ObservationOdds sorted(odds.begin(), odds.end());
    for (auto& [observation, probability] : sorted) probability /= total;
    std::sort(sorted.begin(), sorted.end(), [](const auto& left, const auto& right) {
      return left.second != right.second ? left.second > right.second : left.first < right.first;
    });
    return sorted;
  }

  // The posterior and the logarithm of the observation's probability, which is a density where numbers were observed; an
  // empty belief where that is impossible. `numbers` weighs each step by those that it reports.
  template <class Numbers>
  std::pair<Belief, double> posterior(int action, Observation response, Numbers& numbers, Sampler& random) const {
    while (true) {
      auto [belief, probability] =
          gathered(action, numbers, random, [&](Observation seen) { return seen == response; });
      if (!numbers.rescale()) return {std::move(belief), std::log(probability) + numbers.log_scale()};
    }
  }

  // `share` of `other` and the rest of this one.
  Belief mixed_with(const Belief& other, double share) const {
    Gathering<Model> gathering;
    for (const auto& [state, weight] : particles_) gathering.add(state, weight * (1 - share));
    for (const auto& [state, weight] : other.particles_) gathering.add(state, weight * share);
    const double error_bound = (1 - share) * error_bound_ + share * other.error_bound_;
    Belief mixed{gathering, error_bound, std::max(source_, other.source_)};
    mixed.unobserved_ = unobserved_;
    return mixed;
  }

  const State& sample(Sampler& random) const {
    const double drawn = random.uniform() * cumulative_.back();
    const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), drawn);
    const auto index = std::min<std::size_t>(found - cumulative_.begin(), particles_.size() - 1);
    return particles_[index].state;
  }

  // Of all weights; 1 but for rounding.
  double total() const { return cumulative_.empty() ? 0 : cumulative_.back(); }

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
    Marginals<Model>{particles_}.write(json.begin_object().key("marginals"));
    json.member("entropy", entropy());
    json.member("goal_probability", probability_of(Ending::goal));
    json.member("failure_probability", probability_of(Ending::failure));
    json.member("over_probability", probability_of(Ending::over));
    json.member("states", particles_.size()).member("effective_states", effective_states());
    json.member("is_exact", is_exact()).member("error_bound", error_bound_).end_object();
  }

  // One that was kept.
  static Belief of(const std::vector<Particle>& particles, Unobserved<Model> unobserved, double error_bound,
                   bool is_drawn) {
    Gathering<Model> gathering;
    for (const auto& [state, weight] : particles) gathering.add(state, weight);
    Belief belief{gathering, error_bound, is_drawn ? Source::drawing : Source::enumeration};
    belief.unobserved_ = std::move(unobserved);
    return belief;
  }

  // The same belief, for a model with the same states.
  template <class To>
  Belief<To> as() const {
    Belief<To> result;
    for (const auto& [state, weight] : particles_) result.particles_.push_back({state, weight});
    result.cumulative_ = cumulative_;
    result.error_bound_ = error_bound_;
    result.unobserved_ = unobserved_.template as<To>();
    result.source_ = static_cast<typename Belief<To>::Source>(source_);
    return result;
  }

 private:
  enum class Source { enumeration, drawing };
  template <class>
  friend class Belief;

  Belief() = default;
  Belief(const Gathering<Model>& gathering, double error_bound, Source source)
      : error_bound_(std::min(error_bound, 1.0)), source_(source) {
    const double sum = gathering.total();
    double before = 0;
    for (const auto& [state, weight] : gathering.particles()) {
      if (weight <= negligible_weight * sum) continue;
      particles_.push_back({state, weight / sum});
      cumulative_.push_back(before += weight / sum);
    }
  }

  static std::size_t most_states(Source source) {
    if (source == Source::drawing) return particle_count;
    return std::clamp(most_weighted_bytes / Model::state_bytes(), particle_count, most_weighted_states);
  }
  bool is_thin() const { return is_drawn() && particles_.size() < few_particles; }
  std::size_t most_paths() const {
    return is_drawn() ? most_paths_of_particles : most_enumerated_paths;
  }

  // The outcomes whose observation is of use, as a belief, and their probability.
  //
  // Let two beliefs agree but for a share e of each. What was observed has probability p under this one, and so at least
  // p - e under what they share: after it they agree but for e / p. Thinning out adds what it drops. A density may be
  // any number under the share: where numbers weigh, nothing is known of a belief that is not exact.
  template <class IsOfUse>
  std::pair<Belief, double> gathered(int action, NumberSink& numbers, Sampler& random, IsOfUse&& is_of_use) const {
    Gathering<Model> gathering;
    const auto add = [&](const State& next, Observation seen, double weight) {
      if (!is_of_use(seen) || weight <= 0) return false;
      gathering.add(next, weight);
      return true;
    };
    try {
      if (is_thin()) throw NotEnumerable{"the states were drawn, and are few"};
      const std::size_t most = most_states(source_);
      double gone = 0;
      const auto add_some = [&](const State& next, Observation seen, double weight) {
        add(next, seen, weight);
        if (gathering.size() > 2 * most) gone += gathering.reduce(most, random);
      };
      enumerate_outcomes<Model>(particles_, action, numbers, most_paths(), add_some);
      if (is_drawn() && gathering.size() < few_particles) throw NotEnumerable{"few of the drawn states agree"};
      gone += gathering.reduce(most, random);
      const double probability = gathering.total();
      const double bound_before = error_bound_ > 0 && numbers.weighs() ? probability : error_bound_;
      const double error_bound = probability > 0 ? (bound_before + gone) / probability : 0;
      return {followed(Belief{gathering, error_bound, source_}, action, random), probability};
    } catch (const NotEnumerable&) {
      gathering.clear();
    }
    const double drawn =
        DrawnOutcomes<Model>{particles_, unobserved_, is_thin(), action, numbers, random}.draw(add, [&] { gathering.clear(); });
    const double probability = gathering.total() / drawn;
    gathering.reduce(particle_count, random);
    return {followed(Belief{gathering, 1, Source::drawing}, action, random), probability};
  }

  // What nothing is observed of takes the same action.
  Belief followed(Belief next, int action, Sampler& random) const {
    next.unobserved_ = unobserved_;
    next.unobserved_.step(action, random);
    return next;
  }

  std::vector<Particle> particles_;
  std::vector<double> cumulative_;
  Unobserved<Model> unobserved_;  // of a drawn belief only
  double error_bound_ = 0;
  Source source_ = Source::enumeration;
};

}  // namespace aos
