// What an action can lead to from weighted states: every outcome where steps can be enumerated, drawn ones elsewhere.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <unordered_map>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/fault.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/unobserved.hpp"
#include "aos/model/step.hpp"
#include "aos/model/values.hpp"

namespace aos {

inline constexpr std::size_t particle_count = 5000;
inline constexpr std::size_t most_drawn_steps = 40 * particle_count;
inline constexpr std::size_t most_forgetful_steps = 4 * most_drawn_steps;
inline constexpr std::size_t drawn_at_once = 1000;
inline constexpr int most_completions = 16;
inline constexpr double rare_observation = 0.25;
inline constexpr double desperate_observation = 0.01;
inline constexpr std::size_t few_particles = particle_count / 10;
inline constexpr std::size_t scarce_particles = particle_count / 100;  // hardly any
inline constexpr std::size_t trials_per_mixture = 8;
inline constexpr std::size_t trials_per_mixture_at_last = 2;

// Calls `visit(next, observation, weight)` for every outcome of an action, whose numbers go to `numbers`. Throws
// NotEnumerable where a step cannot be enumerated, or where all together have more than `most_paths` paths, soon if the
// first states tell.
template <class Model, class Visit>
void enumerate_outcomes(const std::vector<Particle<Model>>& particles, int action, NumberSink& numbers,
                        std::size_t most_paths, Visit&& visit) {
  constexpr std::size_t telling = 64;
  Enumerator draws;
  draws.report_to(&numbers);
  std::size_t paths = 0;
  std::size_t states = 0;
  for (const auto& [state, weight] : particles) {
    draws.for_each_path([&](Enumerator& path) {
      if (++paths > most_paths) throw NotEnumerable{"too many outcomes"};
      auto next = state;
      const Step step = Model::step(next, action, path);
      visit(next, step.observation, weight * path.probability());
    });
    if (++states == telling && paths / telling > 2 * most_paths / particles.size()) {
      throw NotEnumerable{"too many outcomes"};
    }
  }
}

// Outcomes at random, until `particle_count` were of use.
//
// Where only few agree with what was observed, whole paths at random are a waste: most find out at their last draws
// that they do not. There the last draws are enumerated, and each path counts by its probability.
//
// Where drawn states have become few, or hardly any agrees with what was observed, what they have in common is chance.
// There some trials start from mixtures of two of them, which keep how often each variable has each value. If hardly any
// of these agrees either, some forget a variable that is open where nothing is observed: it has its value in a state that
// nothing was observed of. Where that does not help they forget four, and at last 16: the fewer, the less of what was
// observed.
template <class Model>
class DrawnOutcomes {
 public:
  using State = typename Model::State;

  // `is_thin`: whether the states were drawn, and have become few.
  DrawnOutcomes(const std::vector<Particle<Model>>& particles, const Unobserved<Model>& unobserved, bool is_thin,
                int action, NumberSink& numbers, Sampler& random)
      : particles_(particles),
        unobserved_(unobserved),
        action_(action),
        random_(random),
        trials_per_mixture_(is_thin ? trials_per_mixture : 0) {
    draws_.report_to(&numbers);
  }

  // Calls `visit(next, observation, weight)`, which says whether it has a use for the outcome, and `restart()` where what
  // was visited so far is to be forgotten, as a better way was found. Returns the weight of all outcomes, visited ones and
  // others; they estimate the distribution without bias.
  template <class Visit, class Restart>
  double draw(Visit&& visit, Restart&& restart) {
    std::size_t trials = 0;
    std::size_t used = 0;
    bool is_rare = false;
    while (trials == 0 || (steps_ < most_steps_ && used < particle_count)) {
      const bool is_pilot = by_chance_ == unknown;
      const std::size_t used_before = used;
      draw_evenly<Model>(particles_, drawn_at_once, random_, [&](const State& drawn) {
        const bool is_mixed = trials_per_mixture_ > 0 && trials % trials_per_mixture_ == 0;
        used += is_mixed ? try_mixture(drawn, is_rare, visit) : try_state(drawn, is_rare, visit);
        if (is_pilot) before_last_.push_back(draws_.draws_before_last(most_completions));
        ++trials;
      });
      if (is_pilot) by_chance_ = median(before_last_);
      const double share = static_cast<double>(used - used_before) / drawn_at_once;
      if (is_pilot && share < rare_observation) {
        is_rare = true;
      } else if (is_rare && !is_desperate_ && share < desperate_observation) {
        is_desperate_ = true;
        trials_per_mixture_ = trials_per_mixture_at_last;
      } else if (used < scarce_particles && steps_ >= most_steps_ && may_forget_more()) {
        most_steps_ += most_drawn_steps;
        forgotten_ = std::max<std::size_t>(4 * forgotten_, 1);
      } else {
        continue;
      }
      restart();
      trials = used = 0;
    }
    return static_cast<double>(trials);
  }

 private:
  static constexpr std::size_t unknown = static_cast<std::size_t>(-1);
  struct Outcome {
    State next;
    Observation observation;
    double probability;
  };
  struct Places {
    std::vector<Place> all;
    std::vector<Place> open;  // which differ where nothing is observed
  };

  template <class Visit>
  std::size_t try_state(const State& state, bool is_rare, Visit& visit) {
    return is_rare ? complete(state, visit) : draw_whole(state, visit);
  }

  // Model code need not make sense of states that cannot be reached; a fault in one says nothing about the model.
  template <class Visit>
  std::size_t try_mixture(const State& drawn, bool is_rare, Visit& visit) {
    try {
      const bool forgets = forgotten_ > 0 && random_.flag(0.5);
      return try_state(forgets ? partly_forgotten(drawn) : mixture(drawn, other()), is_rare, visit);
    } catch (const ModelFault&) {
      return 0;
    }
  }

  const State& other() {
    return particles_[static_cast<std::size_t>(random_.below(static_cast<int>(particles_.size())))].state;
  }

  // Each single value from one or the other, where both have the same ones.
  State mixture(const State& left, const State& right) {
    const Places& places = places_of(left);
    State mixed = left;
    if (&places_of(right) != &places) return mixed;
    for (const Place& place : places.all) {
      if (random_.flag(0.5)) copy_place<Model>(place, right, mixed);
    }
    return mixed;
  }
  State partly_forgotten(const State& state) {
    const Places& places = places_of(state);
    const State& unobserved = unobserved_.draw(random_);
    State result = state;
    if (&places_of(unobserved) != &places || places.open.empty()) return result;
    for (std::size_t i = 0; i < forgotten_; ++i) {
      const auto chosen = static_cast<std::size_t>(random_.below(static_cast<int>(places.open.size())));
      copy_place<Model>(places.open[chosen], unobserved, result);
    }
    return result;
  }

  // States of the same shape share them.
  const Places& places_of(const State& state) {
    leaves_.clear();
    Model::visit_values(state, leaves_);
    const auto [entry, is_new] = places_.try_emplace(leaves_.shape);
    if (is_new) {
      entry->second.all = Model::places(state);
      std::copy_if(entry->second.all.begin(), entry->second.all.end(), std::back_inserter(entry->second.open),
                   [&](const Place& place) { return unobserved_.is_open(place); });
    }
    return entry->second;
  }

  bool may_forget_more() const { return !unobserved_.is_empty() && most_steps_ < most_forgetful_steps; }

  static std::size_t median(std::vector<std::size_t>& numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
  }

  template <class Visit>
  std::size_t draw_whole(const State& state, Visit& visit) {
    State next = state;
    Step step;
    ++steps_;
    draws_.draw_path(random_, [&](Enumerator& path) { step = Model::step(next, action_, path); });
    return visit(next, step.observation, draws_.probability()) ? 1 : 0;
  }

  template <class Visit>
  std::size_t complete(const State& state, Visit& visit) {
    completions_.clear();
    const auto run = [&](Enumerator& path) {
      State next = state;
      const Step step = Model::step(next, action_, path);
      completions_.push_back({next, step.observation, path.probability()});
    };
    if (!draws_.for_each_completion(random_, by_chance_, 4 * most_completions, run)) {
      completions_.clear();
      draws_.redraw_after(by_chance_, run);
    }
    steps_ += completions_.size();
    std::size_t used = 0;
    for (const Outcome& outcome : completions_) {
      used += visit(outcome.next, outcome.observation, outcome.probability) ? 1 : 0;
    }
    return used;
  }

  const std::vector<Particle<Model>>& particles_;
  const Unobserved<Model>& unobserved_;
  int action_;
  Sampler& random_;
  Enumerator draws_;
  std::vector<Outcome> completions_;
  std::vector<std::size_t> before_last_;
  std::size_t by_chance_ = unknown;
  std::size_t trials_per_mixture_;  // 0: there are none
  bool is_desperate_ = false;
  std::size_t forgotten_ = 0;  // how many variables some mixtures forget
  std::size_t steps_ = 0;
  std::size_t most_steps_ = most_drawn_steps;
  LeafNumbers leaves_;
  std::unordered_map<std::uint64_t, Places> places_;  // by shape
};

}  // namespace aos
