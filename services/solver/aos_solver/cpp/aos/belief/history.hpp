// The history since a belief was drawn, and for each particle its trace: the draws that led to it.
//
// A trace is a chain of blocks, one for the origin and one for each step. Particles with common ancestors
// share blocks. A block that was drawn freely is known by the seed of its draws.
#pragma once

#include <optional>

#include "aos/base/add_up.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/draws/replay.hpp"
#include "aos/model/step.hpp"

namespace aos {

// A longer history is closed, and a new one begins: a history costs memory, and time when it is replayed.
inline constexpr std::size_t max_history = 400;

// The draws of one block: the values of the first ones, and the seed of the others. For a guided step, `likelihood` is
// the estimated likelihood of the observation. For any other step it is the density of the observed numbers, or 1.
struct Block {
  List<double> values;
  std::uint64_t seed = 0;
  double likelihood = 1;
  std::uint32_t draws = 0;
};

// The place of a block in a file (kept_traces.hpp): areas are numbered from 1.
struct KeptPlace {
  std::uint64_t area = 0;
  std::uint64_t number = 0;
};

struct Trace {
  std::shared_ptr<const Trace> before;  // null for the origin
  const Trace* origin;                  // itself for the origin
  Block block;
  mutable KeptPlace kept = {};
};
using TraceLink = std::shared_ptr<const Trace>;

inline TraceLink begun_trace(Block block) {
  auto trace = std::make_shared<Trace>(Trace{nullptr, nullptr, std::move(block)});
  trace->origin = trace.get();
  return trace;
}
inline TraceLink longer(TraceLink before, Block block) {
  const Trace* const origin = before->origin;
  return std::make_shared<Trace>(Trace{std::move(before), origin, std::move(block)});
}
// The blocks of a trace, from the origin on.
inline List<const Block*> blocks_of(const TraceLink& trace) {
  List<const Block*> blocks;
  for (const Trace* block = trace.get(); block != nullptr; block = block->before.get()) blocks.push_back(&block->block);
  std::reverse(blocks.begin(), blocks.end());
  return blocks;
}

// An action, what was observed after it, and how its draws were made.
struct HistoryStep {
  int action;
  Observation observation = default_observation;
  bool is_observed = false;
  bool is_guided = false;
  std::uint32_t by_chance = 0;  // how many draws a guided step leaves to chance
  bool guides_numbers = false;  // whether some of the others are continuous
  // The numbers that were observed; null if the step's numbers are ignored. Densities are relative to `log_scale`.
  std::shared_ptr<const ObservedNumbers> numbers = nullptr;
  double log_scale = 0;

  bool agrees(const Step& step) const { return !is_observed || step.observation == observation; }
};

// As long as this object lives, the numbers of replayed steps are weighed as those of the step were.
class NumbersOf {
 public:
  NumbersOf(const HistoryStep& step, Replay& replay) : reporting_(replay, weighed_by(step)) {}
  NumberSink* sink() { return weighed_ ? &*weighed_ : nullptr; }

 private:
  NumberSink* weighed_by(const HistoryStep& step) {
    if (step.numbers != nullptr) weighed_.emplace(*step.numbers, true, step.log_scale);
    return sink();
  }

  std::optional<WeighedNumbers> weighed_;
  ReportingTo<Replay> reporting_;
};

template <class Model>
class History {
 public:
  using State = typename Model::State;

  // A history begins with the documents' initial belief, or with these states.
  History() = default;
  explicit History(const List<Particle<Model>>& particles) {
    auto origins = std::make_shared<Origins>();
    for (const auto& [state, weight] : particles) {
      origins->states.push_back(state);
      origins->cumulative.push_back((origins->cumulative.empty() ? 0 : origins->cumulative.back()) + weight);
    }
    rest_.origins = std::move(origins);
  }

  // The states that a history begins with, and the sums of their weights.
  struct Origins {
    List<State> states;
    List<double> cumulative;

    List<Particle<Model>> particles() const {
      List<Particle<Model>> particles;
      for (std::size_t i = 0; i < states.size(); ++i) {
        particles.push_back({states[i], cumulative[i] - (i > 0 ? cumulative[i - 1] : 0)});
      }
      return particles;
    }
  };
  // All that a history knows beside its steps.
  struct Rest {
    std::shared_ptr<const Origins> origins;  // null where it begins with the documents
    bool has_all_origins = false;
    unsigned since_moves = 0;  // updates
    unsigned pause = 0;        // updates between moves
  };
  const Rest& rest() const { return rest_; }
  History(List<HistoryStep> steps, Rest rest) : steps_(std::move(steps)), rest_(std::move(rest)) {}

  bool begins_with_the_documents() const { return rest_.origins == nullptr; }
  // A number in [0, 1) for which `originate` gives the state with this number.
  double origin_value(std::size_t number, Sampler& random) const {
    const List<double>& cumulative = rest_.origins->cumulative;
    const double below = number > 0 ? cumulative[number - 1] : 0;
    return (below + random.uniform() * (cumulative[number] - below)) / cumulative.back();
  }
  // Whether the particles include all possible origins of the history. Equal states merge, so few origins are
  // no lack then.
  bool has_all_origins() const { return rest_.has_all_origins; }
  void note_all_origins() { rest_.has_all_origins = true; }
  const List<HistoryStep>& steps() const { return steps_; }
  void add(const HistoryStep& step) { steps_.push_back(step); }

  // Whether it is time to move particles of few origins. Moves that do not help are tried less and less often.
  bool is_time_to_move() { return ++rest_.since_moves > rest_.pause; }
  void note_moves(bool have_helped) {
    rest_.since_moves = 0;
    rest_.pause = have_helped ? 0 : 2 * rest_.pause + 1;
  }

  void originate(State& state, Replay& draws) const {
    if (begins_with_the_documents()) return Model::initial(state, draws);
    state = rest_.origins->states[element_at(rest_.origins->cumulative, draws.uniform())];
  }

 private:
  List<HistoryStep> steps_;
  Rest rest_;
};

// The lineage of a particle of a drawn belief.
//
// The particle stands for weight^2 / squares independent samples. `squares` is the sum of the squares of
// their weights, or 0 if the weight is known exactly.
struct Lineage {
  double squares = 0;
  TraceLink trace;  // null if draws were split (split_filter.hpp)

  // The value of `squares` after a draw let the weight grow, where it could have vanished.
  double grown_squares(double weight, double grown) const {
    const double growth = grown / weight;
    return squares * growth * growth + grown * (grown - weight);
  }
};

inline constexpr std::size_t particle_count = 5000;

// A drawn belief: particles with their lineages. The weights are not normalised.
template <class Model>
struct Cloud {
  using State = typename Model::State;

  List<Particle<Model>> particles;
  List<Lineage> lineages;
  History<Model> history;

  bool has_traces() const { return !lineages.empty() && lineages.front().trace != nullptr; }
  double total() const { return total_weight<Model>(particles); }
  // How many independent samples the weights are worth (Kong, Liu and Wong, 1994), up to `particle_count`.
  double effective() const {
    double squares = 0;
    for (const Lineage& lineage : lineages) squares += lineage.squares;
    const double sum = total();
    if (sum <= 0) return 0;
    return std::min(sum * sum / std::max(squares, 1e-300), static_cast<double>(particle_count));
  }
  // How many independent samples the weights of the particles' origins are worth.
  double effective_origins() const {
    List<std::pair<const Trace*, double>> weights;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      weights.emplace_back(lineages[i].trace->origin, particles[i].weight);
    }
    std::sort(weights.begin(), weights.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    add_up_neighbours(weights, &std::pair<const Trace*, double>::first, &std::pair<const Trace*, double>::second);
    double sum = 0;
    double squares = 0;
    for (const auto& [origin, weight] : weights) {
      sum += weight;
      squares += weight * weight;
    }
    return squares > 0 ? sum * sum / squares : 0;
  }
};

// A cloud after a step, and the probability of what was observed.
template <class Model>
struct UpdatedCloud {
  Cloud<Model> cloud;
  double probability;
};

// Collects particles. Equal states are merged, and one of their traces is kept, drawn by weight.
template <class Model>
class GatheredCloud {
 public:
  void add(const typename Model::State& state, double weight, double squares, TraceLink trace, Sampler& random) {
    const std::size_t number = states_.add(state, weight);
    if (number == lineages_.size()) {
      lineages_.push_back({squares, std::move(trace)});
      return;
    }
    lineages_[number].squares += squares;
    if (trace != nullptr && random.flag(weight / states_.particles()[number].weight)) lineages_[number].trace = std::move(trace);
  }
  std::size_t size() const { return lineages_.size(); }

  // Leaves at most so many particles.
  void reduce(std::size_t max_particles, Sampler& random) {
    Cloud<Model> left = thinned(max_particles, {}, random);
    states_.clear();
    for (const auto& [state, weight] : left.particles) states_.add(state, weight);
    lineages_ = std::move(left.lineages);
  }

  // The particles, of which the lightest are thinned out.
  Cloud<Model> thinned(std::size_t max_particles, History<Model> history, Sampler& random) const {
    List<double> weights;
    for (const auto& particle : states_.particles()) weights.push_back(particle.weight);
    thin_out(weights, max_particles, random);
    Cloud<Model> cloud{{}, {}, std::move(history)};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] <= 0) continue;
      const auto& [state, weight] = states_.particles()[i];
      cloud.particles.push_back({state, weights[i]});
      cloud.lineages.push_back({lineages_[i].grown_squares(weight, weights[i]), lineages_[i].trace});
    }
    return cloud;
  }
  // The same as what a step has made of the cloud `before`.
  UpdatedCloud<Model> updated(const Cloud<Model>& before, const HistoryStep& step, std::size_t max_particles, Sampler& random) const {
    History<Model> history = before.history;
    history.add(step);
    Cloud<Model> cloud = thinned(max_particles, std::move(history), random);
    const double probability = cloud.total() / before.total();
    return {std::move(cloud), probability};
  }

 private:
  Gathering<Model> states_;
  List<Lineage> lineages_;
};

}
