// POMCP (Silver and Veness, 2010): Monte-Carlo tree search over histories, from an exact root belief. This file prepares a
// decision and puts its result together; the algorithm is in tree_search.hpp. docs/planning.md lists what departs from the paper.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/function_ref.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/listed/step_table.hpp"
#include "aos/planning/pomcp/best_action.hpp"
#include "aos/planning/pomcp/exploration.hpp"
#include "aos/planning/pomcp/information_price.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/pomcp/search_threads.hpp"
#include "aos/planning/pomcp/tree_search.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/tree_planner.hpp"
#include "aos/planning/values/learned_values.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/prior_values.hpp"
#include "aos/planning/values/simulated_state.hpp"
#include "aos/planning/values/state_values.hpp"
#include "aos/planning/values/wide_values.hpp"

namespace aos {

template <class Model>
class Pomcp final : public TreePlanner<Model> {
 public:
  using State = typename Model::State;

  // `values_states`: whether it may find out what states are worth. Else the tree ends in rollouts.
  Pomcp(const StateSpace<Model>& space, MdpValues<Model>& values, GroupMissions<Model>& missions, bool values_states = true)
      : TreePlanner<Model>(space, values, missions), space_(space), values_(values), values_states_(values_states) {}

  const char* name() const override { return "pomcp"; }

  // Finds out what states are worth, and lists the steps of a small model. The first decision may take long here.
  bool prepare(const Question<Model>& question, Sampler& random, Choosing& /*choosing*/) override {
    get_ready(question, random);
    return true;
  }
  void ponder(int action, const Question<Model>& question, Sampler& random, FunctionRef<bool()> is_over) override {
    get_ready(question, random);
    search_below(action, question, random, is_over);
  }

  // Whether the values of many states can be computed.
  bool has_wide_values(const Belief<Model>& belief, int horizon) { return switches::wide_values && wide_values_.prepare(belief, horizon); }

  Estimates estimates(const Belief<Model>& belief) const override {
    Estimates result(Model::action_count());
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
      result[a] = {value, static_cast<std::uint32_t>(n), running * std::sqrt(squares) / n,
                                             running * reward / n};
    }
    if (prior_.empty() || !switches::prior_draw) return result;
    std::uint32_t max_visits = 0;
    for (const ActionEstimate& estimate : result) max_visits = std::max(max_visits, estimate.n);
    draw_towards(prior_, result, [&](const ActionEstimate& estimate) { return is_well_visited(estimate.n, max_visits); });
    return result;
  }

  List<std::uint64_t> simulations_by_thread() const override { return threads_.simulations(); }
  // How many simulations went through the root.
  std::uint64_t known_simulations() const override {
    std::uint64_t sum = 0;
    for (const auto& tree : threads_.trees()) sum += tree->known_simulations();
    return sum;
  }

  // Keeps the part of the trees below an action and an observation, which is empty if these were never simulated.
  void advance(int action, Observation observation) override {
    for (const auto& tree : threads_.trees()) tree->move_to(action, observation);
  }
  void start_over() override {
    forget();
    price_.start_over();
  }
  void forget() override {
    for (const auto& tree : threads_.trees()) tree->forget();
  }

 protected:
  std::uint64_t search_tree(const Question<Model>& question, Sampler& random, std::string& why) override {
    const std::uint64_t simulations = search_below(-1, question, random, [] { return false; });
    if (source_ == ValueSource::learned) why += "; what states are worth is learned from simulations";
    if (source_ == ValueSource::wide) {
      why += "; without observations all " + std::to_string(wide_values_.states()) + " can be, and their values are computed";
      if (price_of_nat_ > 0) why += "; information has a price";
    }
    return simulations;
  }
  const StateValues<Model>* values_of_ends() const override { return state_values_; }
  bool has_learned_values() const override { return source_ == ValueSource::learned; }
  std::optional<double> lost_by_doubt(const Belief<Model>& belief) const override {
    if (price_of_nat_ <= 0) return {};
    return price_.lost_for_each_nat() * belief.entropy();
  }
  double value_of_states(const Belief<Model>& belief) const override { return belief.probability_of(Ending::running) * mdp_value_; }
  TreeReach reach(const Belief<Model>& belief, const Estimates& estimates, int choice) const override {
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
    const ActionEstimate& chosen = estimates[choice];
    if (chosen.n > 0) result.gain = chosen.q - belief.probability_of(Ending::running) * rolled_out_;
    return result;
  }
  // With a prior every value counts. Where rollouts value new histories, one that is certain does, too.
  bool is_reliable(const ActionEstimate& estimate, const ActionEstimate& most) const override {
    return !prior_.empty() || is_well_visited(estimate.n, most.n) ||
           (switches::certain_actions && rolls_out() && is_certain(estimate, most));
  }

 private:
  enum class ValueSource { none, listed, wide, learned };
  static constexpr Operations cost_by_table = 40;
  static constexpr Operations cost_of_value = 60;  // of a state that code has stepped
  static constexpr Operations cost_of_listed_worth = 20;

  void get_ready(const Question<Model>& question, Sampler& random) {
    const Belief<Model>& belief = question.belief;
    const int horizon = question.horizon;
    threads_.prepare(question.budget.threads);
    state_values_ = known_values(belief, horizon, random);
    const auto worth = [&](const State& state) { return state_values_->value(state, horizon); };
    mdp_value_ = state_values_ != nullptr ? mean_value(belief, worth) : 0;
    prior_.clear();
    has_table_ = false;
    price_of_nat_ = 0;
    if (belief.probability_of(Ending::running) <= 0) return;
    if (switches::priced_information && source_ == ValueSource::wide) price_of_nat_ = price_.of(belief, wide_values_, horizon);
    has_table_ = switches::step_table && source_ == ValueSource::listed && steps_.prepare(space_, belief);
    if (!switches::prior) return;
    if (source_ == ValueSource::learned) prior_ = learned_prior(estimates_, belief, horizon, random);
    if (source_ == ValueSource::listed && space_.leaves_out_observations()) prior_ = listed_prior(values_, space_, belief);
  }

  // Whether rollouts value new histories. No value is then too high because few simulations went on below it.
  bool rolls_out() const { return source_ == ValueSource::none; }

  // Where states are listed, steps by code are compared with steps by the list. Elsewhere all planners step by code.
  Operations cost_of_code() {
    if (source_ != ValueSource::listed) return operations_of_step;
    if (step_cost_ == 0) step_cost_ = cost_of_step<Model>();
    return step_cost_;
  }

  // Searches below one action, or from the root if that is -1.
  std::uint64_t search_below(int first, const Question<Model>& question, Sampler& random, FunctionRef<bool()> is_over) {
    const Belief<Model>& belief = question.belief;
    const Budget budget = question.budget;
    const int horizon = question.horizon;
    const BarredActions barred = first < 0 ? question.barred : BarredActions{};
    const auto start = PlanningClock::now();
    if (belief.probability_of(Ending::running) <= 0) return 0;
    if (rolls_out() && first < 0) roll_out(belief, budget, horizon, Sampler{Sampler{random}.bits()});
    const Operations step_cost = has_table_ ? cost_by_table : cost_of_code() + (rolls_out() ? 0 : cost_of_value);
    const Operations worth_cost = source_ == ValueSource::listed ? cost_of_listed_worth : step_cost;
    for (const auto& tree : threads_.trees()) {
      tree->begin(horizon, prior_, source_ == ValueSource::wide && switches::first_state, barred, step_cost, worth_cost, price_of_nat_);
    }
    const Operations each = rolls_out() ? 0 : Budget::operations_of_simulation(horizon);
    if (has_table_) {
      const auto start_state = [&](Sampler& own) { return ListedState<Model>{steps_, values_, own}; };
      return threads_.simulate(start_state, budget, start, random, first, is_over, each);
    }
    const auto start_state = [&](Sampler& own) { return ComputedState<Model>{belief.sample(own), state_values_}; };
    return threads_.simulate(start_state, budget, start, random, first, is_over, each);
  }

  // What states are worth, as well as it can be known; null if nothing is known of it.
  const StateValues<Model>* known_values(const Belief<Model>& belief, int horizon, Sampler& random) {
    source_ = ValueSource::none;
    if (!values_states_) return nullptr;
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
  static double mean_value(const Belief<Model>& belief, auto&& worth) {
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
  bool values_states_;
  StepTable<Model> steps_;
  Operations step_cost_ = 0;  // 0: not known yet
  WideValues<Model> wide_values_;
  InformationPrice<Model> price_;
  LearnedValues<Model> estimates_;
  // Of the last preparation:
  ValueSource source_ = ValueSource::none;
  const StateValues<Model>* state_values_ = nullptr;  // null if nothing is known of what states are worth
  bool has_table_ = false;  // of steps
  List<double> prior_;
  double mdp_value_ = 0;
  double price_of_nat_ = 0;  // of information
  double rolled_out_ = 0;  // what rollouts return from the belief, where they value new histories
};

}
