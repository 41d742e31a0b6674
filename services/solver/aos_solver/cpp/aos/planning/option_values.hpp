// What a state is worth if it is seen: one way to a reward after the other is taken, up to the horizon. The options of a
// belief count once each; here the same may be earned again and again.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/leaf_cells.hpp"
#include "aos/planning/option_search.hpp"
#include "aos/planning/sampled_belief.hpp"

namespace aos {

template <class Model>
class OptionValues {
 public:
  using State = typename Model::State;

  explicit OptionValues(const LeafCells<Model>& cells) : cells_(cells) {}

  // Values a few states of a belief, the more of them the more steps there are. `steps` is counted down.
  void begin(const SampledBelief<Model>& belief, int horizon, double& steps, Sampler& random) {
    horizon_ = static_cast<std::size_t>(horizon);
    valued_.clear();
    const auto count = static_cast<std::size_t>(std::clamp(of_values * steps / value_steps, fewest_valued, most_valued));
    const std::size_t stride = std::max<std::size_t>(belief.size() / count, 1);
    for (std::size_t k = stride / 2; k < belief.size(); k += stride) {
      valued_.push_back({k, value_of(belief.states()[k], horizon_, steps, random)});
    }
  }

  // How much more the next states are worth than those before, after so many actions.
  double gain_of(const std::vector<State>& next, std::size_t actions, double& steps, Sampler& random) const {
    double gain = 0;
    double count = 0;
    for (const auto& [k, value] : valued_) {
      if (Model::ending(next[k]) != Ending::running) continue;
      gain += value_of(next[k], horizon_ > actions ? horizon_ - actions : 0, steps, random) - value;
      ++count;
    }
    return count > 0 ? gain / count : 0;
  }

  // How much more states are worth than by the values that `seen` has of them.
  template <class Seen>
  double beyond(Seen&& seen) const {
    double sum = 0;
    for (const auto& [k, value] : valued_) sum += value - seen(k);
    return valued_.empty() ? 0 : sum / static_cast<double>(valued_.size());
  }

 private:
  static constexpr double fewest_valued = 3;
  static constexpr double most_valued = 12;
  static constexpr double of_values = 0.25;  // of the steps
  static constexpr int tries = 8;                // of a way
  static constexpr double value_steps = 20'000;  // to find ways from a state

  struct Valued {
    std::size_t state;
    double value;
  };

  double value_of(State state, std::size_t horizon, double& steps, Sampler& random) const {
    OptionSearch<Model> search{cells_};
    double value = 0;
    double discount = 1;
    double left = value_steps;
    while (Model::ending(state) == Ending::running && left > 0) {
      const std::vector<Option> ways = search.from(state, left, random);
      if (ways.empty() || ways.front().size() > horizon) break;
      const Option& way = ways.front();
      State next = state;
      double earned = 0;
      for (int i = 0; i < tries; ++i) {
        next = state;
        earned += taken_option<Model>(way, next, random).earned / tries;
      }
      left -= tries * static_cast<double>(way.size());
      state = std::move(next);
      value += discount * earned;
      discount *= std::pow(Model::discount, way.size());
      horizon -= way.size();
    }
    steps -= value_steps - left;
    return value;
  }

  const LeafCells<Model>& cells_;
  std::size_t horizon_ = 1;
  std::vector<Valued> valued_;
};

}  // namespace aos
