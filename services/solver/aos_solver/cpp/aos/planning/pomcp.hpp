// POMCP (Silver and Veness, 2010): Monte-Carlo tree search over histories, from an exact root belief.
//
// This file prepares a decision and puts its result together. The algorithm is in tree_search.hpp.
// docs/planning.md lists what departs from the paper, with the file of each departure.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/base/random.hpp"
#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/learned_values.hpp"
#include "aos/planning/mdp_values.hpp"
#include "aos/planning/prior_values.hpp"
#include "aos/planning/search_threads.hpp"
#include "aos/planning/simulated_state.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/step_table.hpp"
#include "aos/planning/tree_search.hpp"
#include "aos/planning/wide_values.hpp"

namespace aos {

template <class Model>
class Pomcp {
 public:
  using State = typename Model::State;

  Pomcp(const StateSpace<Model>& space, MdpValues<Model>& values) : space_(space), values_(values) {}

  // Finds out what states are worth, and lists the steps of a small model. The first decision may take long here.
  void prepare(const Belief<Model>& belief, int horizon, int threads, Sampler& random) {
    threads_.prepare(threads);
    state_values_ = known_values(belief, horizon, random);
    const auto worth = [&](const State& state) { return state_values_->value(state, horizon); };
    mdp_value_ = state_values_ != nullptr ? mean_value(belief, worth) : 0;
    prior_.clear();
    has_table_ = false;
    if (belief.probability_of(Ending::running) <= 0) return;
    has_table_ = switches::step_table && source_ == ValueSource::listed && steps_.prepare(space_, belief);
    if (!switches::prior) return;
    if (source_ == ValueSource::learned) prior_ = learned_prior(estimates_, belief, horizon, random);
    if (source_ == ValueSource::listed && space_.leaves_out_observations()) prior_ = listed_prior(values_, space_, belief);
  }

  // Whether the values of many states can be computed.
  bool has_wide_values(const Belief<Model>& belief, int horizon) { return switches::wide_values && wide_values_.prepare(belief, horizon); }

  // Searches from the belief of `prepare`. Returns how many simulations it took, as budget.hpp counts them.
  std::uint64_t search(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred = {}) {
    return search(belief, budget, horizon, random, barred, -1, [] { return false; });
  }

  // Searches below one action while it is carried out, from the belief of `prepare`, until `is_over()`, which is called every millisecond or so.
  template <class IsOver>
  std::uint64_t ponder(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       IsOver&& is_over) {
    return search(belief, budget, horizon, random, {}, action, is_over);
  }

  // An estimate for each action. Values are over the whole belief, whose ended part counts as 0.
  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    std::vector<ActionEstimate> result(static_cast<std::size_t>(Model::action_count()));
    const double running = belief.probability_of(Ending::running);
    for (int a = 0; a < Model::action_count(); ++a) {
      double n = 0;
      double q = 0;
      double squares = 0;
      double reward = 0;
      for (const auto& tree : threads_.trees()) {
        const auto known = tree->known(a);
        n += known.n;
        reward += known.n * known.reward;
        q += known.n * known.q;
        squares += known.n * known.variance;
      }
      if (n == 0) continue;
      const double value = running * (q / n + mdp_value_);
      result[static_cast<std::size_t>(a)] = {value, static_cast<std::uint32_t>(n), running * std::sqrt(squares) / n,
                                             running * reward / n};
    }
    if (prior_.empty() || !switches::prior_draw) return result;
    std::uint32_t max_visits = 0;
    for (const ActionEstimate& estimate : result) max_visits = std::max(max_visits, estimate.n);
    draw_towards(prior_, result, [&](const ActionEstimate& estimate) { return is_well_visited(estimate.n, max_visits); });
    return result;
  }
  // What is known of the values of states, and their mean over the belief of the last search; null and 0 if nothing is known.
  const StateValues<Model>* state_values() const { return state_values_; }
  double value_of_states(const Belief<Model>& belief) const { return belief.probability_of(Ending::running) * mdp_value_; }
  // Where the trees of the last search end, and what they have gained over the rollouts there.
  TreeReach reach(const std::vector<ActionEstimate>& estimates, int choice, const Belief<Model>& belief) const {
    TreeReach result;
    for (int a = 0; a < Model::action_count(); ++a) {
      double beyond = 0;
      double n = 0;
      for (const auto& tree : threads_.trees()) {
        const double visits = tree->known(a).n;
        beyond += visits * tree->beyond(a);
        n += visits;
      }
      result.beyond.push_back(n > 0 ? beyond / n : 1);
    }
    const ActionEstimate& chosen = estimates[static_cast<std::size_t>(choice)];
    if (chosen.n > 0) result.gain = chosen.q - belief.probability_of(Ending::running) * rolled_out_;
    return result;
  }
  // Whether values are drawn towards a prior.
  bool has_prior() const { return !prior_.empty(); }
  // Whether rollouts value new histories. No value is then too high because few simulations went on below it.
  bool rolls_out() const { return source_ == ValueSource::none; }
  // Whether what states are worth was learned, and may be wrong by any amount.
  bool has_learned_values() const { return source_ == ValueSource::learned; }
  // Where the values of states come from in the last search, for a plan's `why`; empty if the state space lists them.
  std::string value_source() const {
    if (source_ == ValueSource::learned) return "what states are worth is learned from simulations";
    if (source_ != ValueSource::wide) return "";
    return "without observations all " + std::to_string(wide_values_.states()) + " can be, and their values are computed";
  }

  const std::vector<std::uint64_t>& simulations_by_thread() const { return threads_.simulations(); }
  // How many simulations went through the root.
  std::uint64_t known_simulations() const {
    std::uint64_t sum = 0;
    for (const auto& tree : threads_.trees()) sum += tree->known_simulations();
    return sum;
  }

  // Keeps the part of the trees below an action and an observation, which is empty if these were never simulated.
  void move_to(int action, Observation observation) {
    for (const auto& tree : threads_.trees()) tree->move_to(action, observation);
  }
  void forget() {
    for (const auto& tree : threads_.trees()) tree->forget();
  }

 private:
  enum class ValueSource { none, listed, wide, learned };
  static constexpr std::uint64_t fewest_rollouts = 10;
  static constexpr std::uint64_t most_rollouts = 100;

  static constexpr Operations cost_by_table = 40;
  static constexpr Operations cost_of_value = 60;  // of a state that code has stepped
  static constexpr Operations cost_of_listed_worth = 20;

  // Where states are listed, steps by code are compared with steps by the list. Elsewhere all planners step by code.
  Operations cost_of_code() {
    if (source_ != ValueSource::listed) return operations_of_step;
    if (step_cost_ == 0) step_cost_ = cost_of_step<Model>();
    return step_cost_;
  }

  template <class IsOver>
  std::uint64_t search(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred, int first, IsOver&& is_over) {
    const auto start = PlanningClock::now();
    if (belief.probability_of(Ending::running) <= 0) return 0;
    if (rolls_out() && first < 0) roll_out(belief, budget, horizon, Sampler{Sampler{random}.bits()});
    const Operations step_cost = has_table_ ? cost_by_table : cost_of_code() + (rolls_out() ? 0 : cost_of_value);
    const Operations worth_cost = source_ == ValueSource::listed ? cost_of_listed_worth : step_cost;
    for (const auto& tree : threads_.trees()) {
      tree->begin(horizon, prior_, source_ == ValueSource::wide && switches::first_state, barred, step_cost, worth_cost);
    }
    threads_.count_by(rolls_out() ? 0 : Budget::operations_of_simulation(horizon));
    if (has_table_) {
      const auto start_state = [&](Sampler& own) { return ListedState<Model>{steps_, values_, own}; };
      return threads_.simulate(start_state, budget, start, random, first, is_over);
    }
    const auto start_state = [&](Sampler& own) { return ComputedState<Model>{belief.sample(own), state_values_}; };
    return threads_.simulate(start_state, budget, start, random, first, is_over);
  }

  // What states are worth, as well as it can be known; null if nothing is known of it.
  const StateValues<Model>* known_values(const Belief<Model>& belief, int horizon, Sampler& random) {
    source_ = ValueSource::none;
    if (switches::listed_values && values_.prepare(belief, horizon)) {
      source_ = ValueSource::listed;
      return &values_;
    }
    if (has_wide_values(belief, horizon)) {
      source_ = ValueSource::wide;
      return &wide_values_;
    }
    if (!switches::learned_values || Model::has_rollout_policy || !estimates_.prepare(belief, horizon, random)) return nullptr;
    source_ = ValueSource::learned;
    return &estimates_;
  }

  // Finds what rollouts return from the belief's running part. It takes a hundredth of a budget in simulations, and draws
  // no number of those that the search draws.
  void roll_out(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    const std::uint64_t wanted = budget.simulations > 0 ? budget.simulations / 100 : most_rollouts;
    double sum = 0;
    double count = 0;
    for (std::uint64_t i = 0; i < std::clamp(wanted, fewest_rollouts, most_rollouts); ++i) {
      State state = belief.sample(random);
      if (Model::ending(state) != Ending::running) continue;
      int left = horizon;
      sum += Model::rollout(state, left, random);
      ++count;
    }
    rolled_out_ = count > 0 ? sum / count : 0;
  }

  // The mean value of the running part of a belief.
  template <class Worth>
  static double mean_value(const Belief<Model>& belief, Worth&& worth) {
    double sum = 0;
    double running = 0;
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) != Ending::running) continue;
      sum += weight * worth(state);
      running += weight;
    }
    return running > 0 ? sum / running : 0;
  }

  SearchThreads<Model> threads_;
  const StateSpace<Model>& space_;
  MdpValues<Model>& values_;
  StepTable<Model> steps_;
  Operations step_cost_ = 0;  // 0: not known yet
  WideValues<Model> wide_values_;
  LearnedValues<Model> estimates_;
  // Of the last preparation:
  ValueSource source_ = ValueSource::none;
  const StateValues<Model>* state_values_ = nullptr;  // null if nothing is known of what states are worth
  bool has_table_ = false;  // of steps
  std::vector<double> prior_;
  double mdp_value_ = 0;
  double rolled_out_ = 0;  // what rollouts return from the belief, where they value new histories
};

}  // namespace aos
