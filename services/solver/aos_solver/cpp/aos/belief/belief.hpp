// A belief: distinct states with weights that sum to 1, and Bayes' rule for it.
//
// If steps can be enumerated, the update is exact. It takes every outcome of every state and merges equal states, so no
// sampling depletes the particles. If there are too many states, the heavy ones stay and the light ones are thinned
// out. If a loop has endless paths, the improbable ones are left out. In both cases the belief bounds its distance from
// the exact one. If steps cannot be enumerated, the belief is drawn from then on: see drawn_step.hpp.
#pragma once

#include "aos/base/statistics.hpp"
#include "aos/belief/drawn_step.hpp"
#include "aos/belief/effort.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/history.hpp"
#include "aos/belief/initial_paths.hpp"
#include "aos/belief/marginals.hpp"
#include "aos/belief/outcomes.hpp"
#include "aos/belief/particle_filter.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/draws/replay.hpp"
#include "aos/text/json.hpp"

namespace aos {

inline constexpr std::size_t max_weighted_states = 100'000;
inline constexpr std::size_t max_weighted_bytes = std::size_t{64} << 20;
inline constexpr int max_initial_paths = 1'000'000;
inline constexpr std::size_t max_enumerated_paths = 1'000'000;  // of one update of an exact belief
inline constexpr std::size_t max_predicted_paths = 200'000;  // beyond these a prediction is drawn
inline constexpr double negligible_weight = 1e-12;
inline constexpr double negligible_error = 1e-6;  // of a belief that counts as exact
inline constexpr double negligible_rounding = 1e-9;  // of a sum of weights

// What a belief becomes after an observation that it held impossible.
enum class ImpossiblePolicy { hold, widen, reset };

using ObservationOdds = List<std::pair<Observation, double>>;

template <class Model>
class Belief {
 public:
  using State = typename Model::State;
  using Particle = aos::Particle<Model>;

  const List<Particle>& particles() const { return cloud_.particles; }
  // Whether it is the exact belief, but for differences that nobody would notice.
  bool is_exact() const { return error_bound_ <= negligible_error; }
  bool is_drawn() const { return source_ == Source::drawing; }
  // Whether more than half of the states were drawn only once, so that there are others. A belief without lineages does not
  // know; then it is enough that there are so many states.
  bool is_mostly_drawn_once() const {
    if (!is_drawn()) return false;
    if (lineages().empty()) return 2 * particles().size() > particle_count;
    std::size_t once = 0;
    for (std::size_t i = 0; i < particles().size(); ++i) {
      // The squares of n samples of equal weight are an n-th of the square of their sum.
      once += lineages()[i].squares > 0.75 * particles()[i].weight * particles()[i].weight;
    }
    return 2 * once > particles().size();
  }
  // How the particles of a drawn belief came to be, if that is known.
  const History<Model>& history() const { return cloud_.history; }
  const List<Lineage>& lineages() const { return cloud_.lineages; }
  bool has_traces() const { return cloud_.has_traces(); }
  // No event's probability is further than this from that of the exact belief. It is 1 if steps were sampled.
  double error_bound() const { return error_bound_; }
  // How many states of equal weight tell as much; for a drawn belief, how many independent samples.
  double effective_states() const {
    if (!lineages().empty()) return cloud_.effective();
    double squares = 0;
    for (const auto& particle : particles()) squares += particle.weight * particle.weight;
    return squares > 0 ? 1 / squares : 0;
  }

  // The documents' initial belief: enumerated if possible, else drawn.
  static Belief initial(Sampler& random) {
    if (estimated_initial_paths<Model>(random) > 2 * max_initial_paths) return drawn(random);
    try {
      Gathering<Model> gathering;
      State state{};
      Enumerator draws;
      double gone = 0;
      const std::size_t limit = max_states(Source::enumeration);
      const auto run = [&](Enumerator& path) { Model::initial(state, path); };
      const auto add = [&](Enumerator& path) {
        gathering.add(state, path.probability());
        if (gathering.size() > 2 * limit) gone += gathering.reduce(limit, random);
      };
      gone += draws.for_nearly_each_path(run, add, max_initial_paths);
      gone += gathering.reduce(limit, random);
      return Belief{gathering, gone, Source::enumeration};
    } catch (const NotEnumerable&) {
      return drawn(random);
    }
  }

  static Belief drawn(Sampler& random) { return Belief{ParticleFilter<Model>{random}.initial()}; }

  // The belief after an action, before any observation.
  Belief predicted(int action, Sampler& random) const { return updated({.action = action}, ignored_numbers, random).first; }

  // The probability of each response after an action, whatever numbers come with it; the likeliest first.
  ObservationOdds observations(int action, Sampler& random) const {
    std::unordered_map<Observation, double> odds;
    const auto add = [&](Observation observation, double weight) { odds[observation] += weight; };
    try {
      if (is_drawn()) throw NotEnumerable{"the states were drawn"};
      enumerate_outcomes<Model>(particles(), action, ignored_numbers, max_predicted_paths,
                                [&](const State&, const State&, Observation seen, double weight) { add(seen, weight); });
    } catch (const NotEnumerable&) {
      odds.clear();
      ParticleFilter<Model>{random}.draw_observations(particles(), action, add);
    }
    ObservationOdds sorted(odds.begin(), odds.end());
    std::ranges::sort(sorted, {}, [](const auto& each) { return std::pair{-each.second, each.first}; });
    return sorted;
  }

  // The posterior, and the logarithm of the observation's probability or, if numbers were observed, of its density. The
  // belief is empty if the observation is impossible. `numbers` weighs each step by the numbers that it reports.
  std::pair<Belief, double> posterior(int action, Observation response, auto& numbers, Sampler& random) const {
    HistoryStep step{.action = action, .observation = response, .is_observed = true};
    if constexpr (requires { numbers.observed(); }) {
      if (Model::reports_numbers()) step.numbers = std::make_shared<const ObservedNumbers>(numbers.observed());
    }
    while (true) {
      step.log_scale = numbers.log_scale();
      auto [belief, probability] = updated(step, numbers, random);
      if (!numbers.rescale()) return {std::move(belief), std::log(probability) + numbers.log_scale()};
    }
  }

  // The belief in which each state is changed by `change(state, draws)`, which nobody observes. It has no history.
  Belief changed(auto&& change, Sampler& random) const {
    try {
      if (is_drawn()) throw NotEnumerable{"the states were drawn"};
      Gathering<Model> gathering;
      Enumerator draws;
      const std::size_t limit = max_states(source_);
      double gone = 0;
      std::size_t paths = 0;
      State next{};
      for (const auto& [state, weight] : particles()) {
        const auto run = [&](Enumerator& path) {
          if (++paths > max_enumerated_paths) throw NotEnumerable{"too many outcomes"};
          next = state;
          change(next, path);
        };
        gone += weight * draws.for_nearly_each_path(run, [&](Enumerator& path) {
          gathering.add(next, weight * path.probability());
          if (gathering.size() > 2 * limit) gone += gathering.reduce(limit, random);
        });
      }
      gone += gathering.reduce(limit, random);
      return Belief{gathering, error_bound_ + gone, source_};
    } catch (const NotEnumerable&) {
      return changed_by_drawing(change, random);
    }
  }

  // The belief at the start of a mission that nothing belongs to yet, after so many steps of extrinsic changes alone.
  Belief begun(int idle_steps, Sampler& random) const {
    Belief now = without_history();
    const int at_once = std::min(idle_steps, 1);
    for (int step = 0; step < std::max(idle_steps, 1); ++step) {
      now = now.changed([at_once](State& state, DirectedDraws& draws) { Model::begin(state, at_once, draws); }, random);
    }
    return now;
  }

  // The belief given that `holds(state)`, and the logarithm of its probability. It is empty where that is impossible. If
  // some share e of the belief is wrong, the event has at least its probability p - e in the rest.
  std::pair<Belief, double> conditioned(auto&& holds) const {
    Gathering<Model> gathering;
    for (const auto& [state, weight] : particles()) {
      if (holds(state)) gathering.add(state, weight);
    }
    const double probability = gathering.total() / total();
    if (gathering.size() == 0) return {Belief{}, -std::numeric_limits<double>::infinity()};
    return {Belief{gathering, error_bound_ / probability, source_}, std::log(probability)};
  }

  // A mixture: `share` of `other` and the rest of this belief.
  Belief mixed_with(const Belief& other, double share) const {
    Gathering<Model> gathering;
    for (const auto& [state, weight] : particles()) gathering.add(state, weight * (1 - share));
    for (const auto& [state, weight] : other.particles()) gathering.add(state, weight * share);
    const double error_bound = (1 - share) * error_bound_ + share * other.error_bound_;
    return Belief{gathering, error_bound, std::max(source_, other.source_)};
  }

  const State& sample(Sampler& random) const {
    return particles()[element_at(cumulative_, random.uniform())].state;
  }

  // The sum of the weights: 1 but for rounding.
  double total() const { return cumulative_.empty() ? 0 : cumulative_.back(); }

  double probability_of(Ending ending) const {
    double sum = 0;
    bool is_certain = !particles().empty();
    for (const auto& [state, weight] : particles()) {
      const bool has_it = Model::ending(state) == ending;
      sum += has_it ? weight : 0;
      is_certain = is_certain && has_it;
    }
    // Rounded weights sum up to a little less than one: a mission that wants certainty would never end.
    return is_certain ? 1 : std::min(sum, 1.0);
  }

  // The entropy in nats.
  double entropy() const { return std::max(entropy_of(particles(), &Particle::weight), 0.0); }

  // These write members of an object: a summary for people, and the probabilities of the endings alone.
  void write_members(JsonWriter& json) const {
    Marginals<Model>{particles()}.write(json.key("marginals"));
    json.member("entropy", entropy());
    write_endings(json);
    json.member("states", particles().size()).member("effective_states", effective_states());
    json.member("is_exact", is_exact()).member("error_bound", error_bound_);
  }
  void write_endings(JsonWriter& json) const {
    json.member("goal_probability", probability_of(Ending::goal));
    json.member("failure_probability", probability_of(Ending::failure));
    json.member("over_probability", probability_of(Ending::over));
  }

  // A belief that was saved, with the same weights. If a drawn one was saved with lineages and a history, it has these again.
  static Belief of(Cloud<Model> cloud, double error_bound, bool is_drawn) {
    // Dividing the weights of a whole belief again would change their last bits.
    const double total = cloud.total();
    const double sum = std::abs(total - 1) < negligible_rounding ? 1 : total;
    if (is_drawn && !cloud.lineages.empty()) return Belief{cloud, sum};
    Gathering<Model> gathering;
    for (const auto& [state, weight] : cloud.particles) gathering.add(state, weight);
    return Belief{gathering, sum, error_bound, is_drawn ? Source::drawing : Source::enumeration};
  }

  Belief without_history() const {
    Belief alone = *this;
    alone.cloud_.lineages.clear();
    alone.cloud_.history = {};
    return alone;
  }

 private:
  enum class Source { enumeration, drawing };

  Belief() = default;
  Belief(const Gathering<Model>& gathering, double error_bound, Source source)
      : Belief(gathering, gathering.total(), error_bound, source) {}
  Belief(const Gathering<Model>& gathering, double sum, double error_bound, Source source)
      : error_bound_(std::min(error_bound, 1.0)), source_(source) {
    for (const auto& [state, weight] : gathering.particles()) {
      if (weight > negligible_weight * sum) add(state, weight / sum);
    }
  }
  explicit Belief(Cloud<Model> cloud) : Belief(cloud, cloud.total()) {}
  Belief(Cloud<Model>& cloud, double sum) : error_bound_(1), source_(Source::drawing) {
    cloud_.history = std::move(cloud.history);
    for (std::size_t i = 0; i < cloud.particles.size(); ++i) {
      add(cloud.particles[i].state, cloud.particles[i].weight / sum);
      cloud_.lineages.push_back({cloud.lineages[i].squares / sum / sum, std::move(cloud.lineages[i].trace)});
    }
  }
  void add(const State& state, double weight) {
    cloud_.particles.push_back({state, weight});
    cumulative_.push_back((cumulative_.empty() ? 0 : cumulative_.back()) + weight);
  }

  static std::size_t max_states(Source source) {
    if (source == Source::drawing) return particle_count;
    return std::clamp(max_weighted_bytes / Model::state_bytes(), particle_count, max_weighted_states);
  }

  // The belief after a step, by enumeration or else by drawing, and the probability of what was observed.
  //
  // Let two beliefs agree but for a share e of each. If the observation has probability p under this one, it
  // has at least p - e under their common part. So the posteriors agree but for e / p. Thinning out adds what
  // it drops, and so do paths that are left out. A density may be any number under the share e: if numbers
  // weigh, the bound is 1 unless the belief is exact.
  std::pair<Belief, double> updated(const HistoryStep& step, NumberSink& numbers, Sampler& random) const {
    if (is_drawn()) return stepped(step, numbers, random);
    try {
      Gathering<Model> gathering;
      const std::size_t limit = max_states(source_);
      double gone = 0;
      const auto add = [&](const State&, const State& next, Observation seen, double weight) {
        ++update_effort.steps;
        if ((step.is_observed && seen != step.observation) || weight <= 0) return;
        gathering.add(next, weight);
        if (gathering.size() > 2 * limit) gone += gathering.reduce(limit, random);
      };
      gone += enumerate_outcomes<Model>(particles(), step.action, numbers, max_enumerated_paths, add);
      gone += gathering.reduce(limit, random);
      const double probability = gathering.total();
      const bool is_unbounded = numbers.weighs() && error_bound_ + gone > 0;
      const double error_bound = probability > 0 ? (is_unbounded ? probability : error_bound_ + gone) / probability : 0;
      return {Belief{gathering, error_bound, source_}, probability};
    } catch (const NotEnumerable&) {
      return stepped(step, numbers, random);
    }
  }

  // Each state is changed once for each sample that its weight is worth, at least once.
  Belief changed_by_drawing(auto&& change, Sampler& random) const {
    Gathering<Model> gathering;
    Replay replay;
    const List<double> none;
    for (const auto& [state, weight] : particles()) {
      const double trials = std::max(1.0, std::ceil(weight * particle_count));
      for (double trial = 0; trial < trials; ++trial) {
        State next = state;
        replay.start(none, random);
        change(next, replay);
        gathering.add(next, weight / trials);
      }
    }
    gathering.reduce(particle_count, random);
    return Belief{gathering, 1, Source::drawing};
  }

  std::pair<Belief, double> stepped(const HistoryStep& step, NumberSink& numbers, Sampler& random) const {
    auto updated = drawn_step(cloud_, !is_drawn(), step, numbers, max_states(Source::enumeration), random);
    if (updated.cloud.particles.empty()) return {Belief{}, 0};
    return {Belief{std::move(updated.cloud)}, updated.probability};
  }

  Cloud<Model> cloud_;  // with lineages where it is drawn
  List<double> cumulative_;
  double error_bound_ = 0;
  Source source_ = Source::enumeration;
};

}
