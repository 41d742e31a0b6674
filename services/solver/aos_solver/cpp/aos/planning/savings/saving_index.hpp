// Ways that save something, and their index: what each saves from a state in each step, on average under other luck. What
// is worth doing again and again counts by its income: a way that saves more and takes longer may save less in the end.
#pragma once

#include "aos/base/progress.hpp"
#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/savings/rest_values.hpp"
#include "aos/planning/savings/saving_search.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

template <class Model>
class SavingIndex final : public StateValues<Model> {
 public:
  using State = typename Model::State;

  // Learns what states are worth after a way, finds ways, and plays missions by their index that see the state. Returns
  // what these return on average; minus infinity where that is not beyond doubt more than rests return.
  double learn(BasePolicy base, const LeafCells<Model>& cells, const Belief<Model>& belief, int horizon, Sampler random) {
    return values_.learn(base, belief, horizon, random) ? practise(cells, belief, horizon, random) : nothing;
  }
  // The same with the values that another index has learned, once they are improved.
  double improve(const SavingIndex& other, const LeafCells<Model>& cells, const Belief<Model>& belief, int horizon, Sampler random) {
    values_ = other.values_;
    return values_.improve(belief, random) ? practise(cells, belief, horizon, random) : nothing;
  }

  // Looks for ways from a state. `steps` is counted down.
  void extend(const LeafCells<Model>& cells, const State& state, double& steps, Sampler& random) {
    SavingSearch<Model> search{cells, values_};
    for (const Option& way : search.from(state, steps, random)) add_with_rests(ways_, way, way.size(), most_ways);
  }

  void measure(const List<State>& states, const StateWeights& weights, double& steps, Sampler& random) {
    incomes_.assign(ways_.size(), 0);
    for (std::size_t k = 0; k < states.size(); ++k) {
      const StepLuck luck{random};
      const Rest<Model> rest{values_, states[k], SavingSearch<Model>::longest, luck};
      steps -= steps_of_rest(SavingSearch<Model>::longest + values_.settling());
      for (std::size_t i = 0; i < ways_.size(); ++i) {
        incomes_[i] += weights[k] * income<Model>(saved(values_, rest, ways_[i], states[k], luck), ways_[i].size());
        steps -= steps_of_way(ways_[i].size() + values_.settling());
      }
    }
  }

  // Keeps the ways with the highest incomes that were measured, where they are many.
  void drop_worst() {
    if (ways_.size() <= kept_ways) return;
    List<std::size_t> order(ways_.size());
    std::iota(order.begin(), order.end(), 0);
    incomes_.resize(ways_.size(), 0);
    sort_stably(order, [&](std::size_t one, std::size_t other) { return incomes_[one] > incomes_[other]; });
    List<Option> kept;
    for (std::size_t i = 0; i < kept_ways; ++i) kept.push_back(std::move(ways_[order[i]]));
    ways_ = std::move(kept);
  }

  // What a state is worth to a robot that does not plan, and what the best way with each action saves in a step.
  double value(const State& state, int left) const override { return left > 0 ? values_.value(state) : 0; }
  void advantages(const State& state, double* worths, Sampler& random) const override {
    constexpr double none = -1e100;
    std::fill_n(worths, Model::action_count(), none);
    worths[values_.action()] = 0;
    const StepLuck luck{random};
    const Rest<Model> rest{values_, state, SavingSearch<Model>::longest, luck};
    for (std::size_t i = 0; i < std::min(decided_.size(), followed); ++i) {
      const Option& way = decided_[i].first;
      double& worth = worths[way.front()];
      worth = std::max(worth, income<Model>(saved(values_, rest, way, state, luck), way.size()));
    }
  }

  const RestValues<Model>& values() const { return values_; }
  const List<Option>& ways() const { return ways_; }
  double income_of(std::size_t way) const { return incomes_[way]; }

 private:
  static constexpr double nothing = -std::numeric_limits<double>::infinity();  // is saved beyond doubt
  static constexpr int missions = 20;   // that are played
  static constexpr int practised = 4;  // of these, in which ways are looked for
  static constexpr int between_looks = 6;  // steps of these
  static constexpr std::size_t followed = 32;  // ways that have decided most often
  static constexpr std::size_t most_ways = 128;
  static constexpr std::size_t kept_ways = 64;

  double practise(const LeafCells<Model>& cells, const Belief<Model>& belief, int horizon, Sampler& random) {
    ways_.clear();
    incomes_.clear();
    decided_.clear();
    constexpr double beyond_doubt = 2;  // standard errors
    double sum = 0;
    SampleMean more;
    for (int mission = 0; mission < missions; ++mission) {
      progress::tell("finding out what can be saved", mission, missions);
      const State start = belief.sample(random);
      if (Model::ending(start) != Ending::running) continue;
      const double returned = played(start, mission < practised ? &cells : nullptr, horizon, random);
      if (mission < practised) continue;
      sum += returned;
      more.add(returned - values_.returned(values_.action(), start, StepLuck{random}));
    }
    return more.count() > 1 && more.mean() > beyond_doubt * more.error() ? sum / more.count() : nothing;
  }

  // The return of a mission that sees the state. With `cells` ways are looked for.
  double played(State state, const LeafCells<Model>* cells, int horizon, Sampler& random) {
    double steps = std::numeric_limits<double>::max();
    const auto take = [&](std::size_t step) {
      if (cells != nullptr && step % between_looks == 0) extend(*cells, state, steps, random);
      measure({state}, {1.0}, steps, random);
      return Model::step(state, best_action(), random).reward;
    };
    return earned_in<Model>(horizon, state, take).sum;
  }
  int best_action() {
    const auto best = std::ranges::max_element(incomes_);
    if (best == incomes_.end() || *best <= 0) return values_.action();
    const Option& way = ways_[best - incomes_.begin()];
    note_decided(way);
    return way.front();
  }
  void note_decided(const Option& way) {
    auto entry = std::ranges::find(decided_, way, &std::pair<Option, int>::first);
    if (entry == decided_.end()) entry = decided_.insert(entry, {way, 0});
    ++entry->second;
    for (; entry != decided_.begin() && (entry - 1)->second < entry->second; --entry) std::iter_swap(entry - 1, entry);
  }

  RestValues<Model> values_;
  List<Option> ways_;
  List<double> incomes_;  // by way, as they were measured
  List<std::pair<Option, int>> decided_;  // ways that decided in played missions, and how often, most often first
};

}
