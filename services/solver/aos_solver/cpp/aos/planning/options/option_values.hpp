// What a few states of a belief are worth if they are seen, and what is gained by actions that lead from them to others. The
// options of a belief count once each; here the same may be earned again and again.
#pragma once

#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_following.hpp"
#include "aos/planning/options/option_library.hpp"
#include "aos/planning/options/sampled_belief.hpp"

namespace aos {

template <class Model>
class OptionValues {
 public:
  using State = typename Model::State;

  OptionValues(const OptionLibrary<Model>& library, DecisionClock& clock) : following_(library), clock_(clock) {}

  // Values a few states of a belief. `gains` times the gain of actions will be asked for: the fewer, the more states, and the
  // further they are followed. `steps` is counted down.
  void begin(const SampledBelief<Model>& belief, int horizon, std::size_t gains, double& steps, Sampler& random) {
    horizon_ = horizon;
    valued_.clear();
    following_.begin();
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
    double sum = 0;
    double weights = 0;
    for (const auto& [k, weight, followed] : valued_) {
      sum += weight * (followed.earned - seen(k));
      weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
  }
  // The share of the valued states in which the mission goes on after what is earned.
  double goes_on() const {
    double sum = 0;
    double weights = 0;
    for (const auto& [k, weight, followed] : valued_) {
      sum += followed.discount > 0 ? weight : 0;
      weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
  }
  // What is earned in the valued states, and the discount of what comes after that.
  Followed mean() const {
    Followed mean{0, 0};
    double weights = 0;
    for (const auto& [k, weight, followed] : valued_) {
      mean.earned += weight * followed.earned;
      mean.discount += weight * followed.discount;
      weights += weight;
    }
    return {mean.earned / weights, mean.discount / weights};
  }

 private:
  static constexpr std::size_t fewest_valued = 3;
  static constexpr std::size_t most_valued = 16;
  static constexpr double of_values = 0.6;             // of the steps
  static constexpr double least_value_steps = 10'000;  // to follow options from a state
  static constexpr double most_value_steps = 20'000;

  struct Valued {
    std::size_t state;
    double weight;
    Followed followed;
  };

  // All states have as many steps and as much time, so that their values compare.
  Followed followed(const State& state, std::size_t horizon, double& steps, Sampler& random) const {
    const DecisionClock::Slice one(clock_, one_s_);
    return following_.follow(state, horizon, value_steps_, steps, random);
  }

  // A step that goes through all numbers below a count, far apart from one to the next.
  static std::size_t coprime_jump(std::size_t count) {
    std::size_t jump = std::max<std::size_t>(count * 3 / 8, 1);
    while (std::gcd(jump, count) != 1) ++jump;
    return jump;
  }

  OptionFollowing<Model> following_;
  DecisionClock& clock_;
  std::size_t horizon_ = 1;
  double value_steps_ = most_value_steps;
  double one_s_ = 0;
  List<Valued> valued_;
};

}
