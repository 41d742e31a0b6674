// What an action saves in each step if the best way is taken after it, given what is then observed.
//
// States that tell the same belong together, and so do all with rare observations. Half of the states of a group choose the
// way, and the others tell what it saves, and the other way round: the best way for a few drawn states is too good for these.
#pragma once

#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/same_observation.hpp"
#include "aos/planning/savings/rest_values.hpp"
#include "aos/planning/savings/saving_search.hpp"

namespace aos {

template <class Model>
class SavingLookahead {
 public:
  using State = typename Model::State;

  SavingLookahead(const RestValues<Model>& values, const List<Option>& ways) : values_(values), ways_(ways) {}

  // How many steps of the model an action takes, once begun.
  double steps_of_action() const {
    double sum = steps_of_way(1 + values_.settling());
    for (const Option& way : ways_) sum += steps_of_way(way.size() + values_.settling());
    return sum * belief_->size();
  }

  // Draws the luck of the states, under which all actions are compared.
  void begin(const SampledBelief<Model>& belief, Sampler& random) {
    belief_ = &belief;
    lucks_.clear();
    rests_.clear();
    for (const State& state : belief.states()) {
      lucks_.emplace_back(random);
      rests_.emplace_back(values_, state, SavingSearch<Model>::longest + 1, lucks_.back());
    }
  }

  // The income of an action, with what follows.
  double income_of(int action) {
    const std::size_t states = belief_->size();
    told_.clear();
    incomes_.resize(states * (ways_.size() + 1));
    for (std::size_t k = 0; k < states; ++k) take(action, k);
    double sum = 0;
    for_each_group(told_, smallest_group, [&](std::span<const Told> alike) { sum += of_group(alike); });
    return sum;
  }

 private:
  static constexpr std::size_t smallest_group = 8;
  struct Told {
    Observation observation;
    std::size_t state;
  };

  // Takes the action, and then each way or nothing, from a state.
  void take(int action, std::size_t k) {
    State next = belief_->states()[k];
    Sampler random = lucks_[k].of(0);
    const Step step = Model::step(next, action, random);
    told_.push_back({step.observation, k});
    double* const incomes = &incomes_[k * (ways_.size() + 1)];
    for (std::size_t i = 0; i <= ways_.size(); ++i) {
      const Option& way = i < ways_.size() ? ways_[i] : nothing_;
      const double returned = returned_along(values_, way, next, lucks_[k], step.reward, 1);
      incomes[i] = income<Model>(returned - rests_[k].returned(way.size() + 1 + values_.settling()), way.size() + 1);
    }
  }

  // The income of a group, times its weight.
  double of_group(std::span<const Told> group) {
    const auto income_of = [&](const Told& told, std::size_t way) {
      return belief_->weights()[told.state] * incomes_[told.state * best_.size() + way];
    };
    double sum = 0;
    for (std::size_t half = 0; half < 2; ++half) {
      // One state alone knows nothing: it goes by itself.
      const bool is_split = group.size() > 1;
      best_.assign(ways_.size() + 1, 0);
      for (std::size_t j = 0; j < group.size(); ++j) {
        if (is_split && j % 2 != half) continue;
        for (std::size_t i = 0; i < best_.size(); ++i) best_[i] += income_of(group[j], i);
      }
      const auto best = static_cast<std::size_t>(std::ranges::max_element(best_) - best_.begin());
      for (std::size_t j = 0; j < group.size(); ++j) {
        if (!is_split || j % 2 != half) sum += (is_split ? 1 : 0.5) * income_of(group[j], best);
      }
    }
    return sum;
  }

  const RestValues<Model>& values_;
  const List<Option>& ways_;
  const Option nothing_;  // to do after an action
  const SampledBelief<Model>* belief_ = nullptr;
  List<StepLuck> lucks_;       // by state
  List<Rest<Model>> rests_;    // by state
  List<double> incomes_;       // [state * (ways + 1) + way], of the action at hand
  List<Told> told_;
  List<double> best_;
};

}
