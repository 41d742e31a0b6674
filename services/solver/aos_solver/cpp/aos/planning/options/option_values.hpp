// What a few states of a belief are worth if they are seen, and what is gained by actions that lead from them to others. The
// options of a belief count once each; here known options are followed, one after the other, up to the horizon, and the same may be earned again and
// again. Where none of them earns anything, a search looks for another one.
#pragma once

#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_library.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/sampled_belief.hpp"

namespace aos {

// What options earn that are followed, and the discount of what comes after them, which is 0 where the mission has ended.
struct Followed {
  double earned = 0;
  double discount = 1;
};

template <class Model>
class OptionValues {
 public:
  using State = typename Model::State;

  OptionValues(const OptionLibrary<Model>& library, DecisionClock& clock) : library_(library), clock_(clock) {}

  // Values a few states of a belief. `gains` times the gain of actions will be asked for: the fewer, the more states, and the
  // further they are followed. `steps` is counted down.
  void begin(const SampledBelief<Model>& belief, int horizon, std::size_t gains, double& steps, Sampler& random) {
    horizon_ = horizon;
    valued_.clear();
    found_.clear();
    const double affordable = of_values * steps / (1 + gains);
    value_steps_ = std::clamp(affordable / fewest_valued, least_value_steps, most_value_steps);
    one_s_ = of_values * clock_.left_s() / ((1 + gains) * fewest_valued);
    const double latest_s = clock_.left_s() - fewest_valued * one_s_;
    const double before = steps;
    // States at a distance first, so that those that are valued are spread over the belief.
    const std::size_t stride = std::max<std::size_t>(belief.size() / most_valued, 1);
    const std::size_t count = std::min(belief.size(), most_valued);
    const std::size_t jump = coprime_jump(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (i >= fewest_valued && (before - steps) * static_cast<double>(i + 1) / static_cast<double>(i) > affordable) break;
      if (i >= fewest_valued && clock_.is_limited() && clock_.left_s() < latest_s) break;
      const std::size_t k = i * jump % count * stride;
      valued_.push_back({k, belief.weights()[k], followed(belief.states()[k], horizon_, steps, random)});
    }
  }

  // How much more the next states are worth than those before, after so many actions, less its standard error: of many gains
  // that are as uncertain, the highest one is too high. Where there is no time to value them it is 0.
  double gain_of(const List<State>& next, std::size_t actions, double& steps, Sampler& random) const {
    double gain = 0;
    double weights = 0;
    List<std::pair<double, double>> gains;  // weight and gain
    for (const auto& [k, weight, before] : valued_) {
      if (Model::ending(next[k]) != Ending::running) continue;
      if (clock_.left_s() < one_s_) return 0;
      const std::size_t left = horizon_ > actions ? horizon_ - actions : 0;
      gains.emplace_back(weight, followed(next[k], left, steps, random).earned - before.earned);
      gain += weight * gains.back().second;
      weights += weight;
    }
    if (!(weights > 0)) return 0;
    gain /= weights;
    double squares = 0;
    for (const auto& [weight, of_state] : gains) squares += weight * weight * (of_state - gain) * (of_state - gain);
    return gain - std::sqrt(squares) / weights;
  }

  // How much more states are worth than by the values that `seen` has of them.
  double beyond(auto&& seen) const {
    return mean_of([&](const Valued& valued) { return valued.followed.earned - seen(valued.state); });
  }
  // The share of the valued states in which the mission goes on after what is earned.
  double goes_on() const {
    return mean_of([](const Valued& valued) { return valued.followed.discount > 0 ? 1.0 : 0.0; });
  }
  // What is earned in the valued states, and the discount of what comes after that.
  Followed mean() const {
    return {mean_of([](const Valued& valued) { return valued.followed.earned; }), mean_of([](const Valued& valued) { return valued.followed.discount; })};
  }

 private:
  static constexpr std::size_t fewest_valued = 3;
  static constexpr std::size_t most_valued = 16;
  static constexpr double of_values = 0.6;             // of the steps
  static constexpr double least_value_steps = 10'000;  // to follow options from a state
  static constexpr double most_value_steps = 20'000;
  static constexpr std::size_t tried_again = 3;  // options that earned most at the first try
  static constexpr int tries = 4;                // of each of them
  static constexpr std::size_t most_found = 64;

  struct Valued {
    std::size_t state;
    double weight;
    Followed followed;
  };
  struct Best {
    Option option{};
    double earned = 0;  // on average
    State after{};      // of the last try
  };
  struct Tried {
    double income;
    const Option* option;
    double earned;
    bool ends;  // the mission
  };

  // The mean over the valued states.
  double mean_of(auto&& of) const {
    double sum = 0;
    double weights = 0;
    for (const Valued& valued : valued_) {
      sum += valued.weight * of(valued);
      weights += valued.weight;
    }
    return weights > 0 ? sum / weights : 0;
  }

  // Follows options for so many steps of a mission. All states have about as many steps of the model and as much time, so that their
  // values compare; `steps` is counted down.
  Followed followed(State state, std::size_t horizon, double& steps, Sampler& random) const {
    const DecisionClock::Slice one(clock_, one_s_);
    Followed followed;
    double left = value_steps_;
    while (Model::ending(state) == Ending::running && left > 0 && !library_.clock().is_over()) {
      Best best = best_known(state, horizon, left, random);
      if (best.option.empty()) best = best_searched(state, horizon, left, random);
      if (best.option.empty()) break;
      followed.earned += followed.discount * best.earned;
      followed.discount *= std::pow(Model::discount, best.option.size());
      horizon -= best.option.size();
      state = std::move(best.after);
    }
    if (Model::ending(state) != Ending::running) followed.discount = 0;
    steps -= value_steps_ - left;
    return followed;
  }

  Best best_known(const State& state, std::size_t horizon, double& left, Sampler& random) const {
    first_.clear();
    for (const List<Option>* options : {&library_.options(), &std::as_const(found_)}) {
      for (const Option& option : *options) {
        if (option.size() > horizon) continue;
        State next = state;
        const double earned = taken_option<Model>(option, next, random, library_.retries()).earned;
        left -= option.size();
        if (earned > 0) first_.push_back({income<Model>(earned, option.size()), &option, earned, Model::ending(next) != Ending::running});
      }
    }
    const auto count = static_cast<std::ptrdiff_t>(std::min(tried_again, first_.size()));
    const auto sort_first = [&](auto&& comes_before) { std::partial_sort(first_.begin(), first_.begin() + count, first_.end(), comes_before); };
    sort_first([](const Tried& one, const Tried& other) { return one.income > other.income; });
    // After an end nothing is earned, so that ends compare by what they earn in all.
    const bool ends = !first_.empty() && first_.front().ends;
    if (ends) sort_first([](const Tried& one, const Tried& other) { return std::pair(one.ends, one.earned) > std::pair(other.ends, other.earned); });
    Best best;
    double most = 0;
    for (auto entry = first_.begin(); entry != first_.begin() + count; ++entry) {
      Best again = tried(*entry->option, state, left, random);
      const double now = ends ? again.earned : income<Model>(again.earned, again.option.size());
      if (now <= most) continue;
      most = now;
      best = std::move(again);
    }
    return best;
  }

  Best best_searched(const State& state, std::size_t horizon, double& left, Sampler& random) const {
    OptionSearch<Model> search{library_.searched_cells(), library_.clock(), library_.retries(), library_.counts()};
    const List<Option> ways = search.from(state, left, random);
    if (ways.empty() || ways.front().size() > horizon) return {};
    if (found_.size() < most_found) found_.push_back(ways.front());
    return tried(ways.front(), state, left, random);
  }

  Best tried(const Option& option, const State& state, double& left, Sampler& random) const {
    Best best{option, 0, state};
    for (int i = 0; i < tries; ++i) {
      best.after = state;
      best.earned += taken_option<Model>(option, best.after, random, library_.retries()).earned / tries;
    }
    left -= tries * static_cast<double>(option.size());
    return best;
  }

  // A step that goes through all numbers below a count, far apart from one to the next.
  static std::size_t coprime_jump(std::size_t count) {
    std::size_t jump = std::max<std::size_t>(count * 3 / 8, 1);
    while (std::gcd(jump, count) != 1) ++jump;
    return jump;
  }

  const OptionLibrary<Model>& library_;
  DecisionClock& clock_;
  std::size_t horizon_ = 1;
  double value_steps_ = most_value_steps;
  double one_s_ = 0;
  List<Valued> valued_;
  mutable List<Tried> first_;
  mutable List<Option> found_;  // by searches of this decision
};

}
