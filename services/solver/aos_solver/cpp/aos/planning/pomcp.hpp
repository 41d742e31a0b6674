// POMCP (Silver and Veness, 2010): Monte-Carlo tree search over histories, from an exact root belief.
//
// What differs from the paper, and why:
// - Where the states that matter are few enough, returns are counted from the fully observable (MDP) value of a state
//   (mdp_values.hpp): a step earns its reward and the change of that worth. Nothing changes in which action is best, but luck
//   of the state no longer blurs the returns, and what is left to find is the cost of not seeing. A new history starts at
//   0, as if all were seen from there on.
// - Where there are too many states, and no rollout policy, the same is done with an estimate of that worth, learned before
//   the first decision (learned_values.hpp). What each action is worth on average over the belief, to somebody who sees the
//   state after it (Littman, Cassandra and Kaelbling, 1995), then is the order in which actions are tried everywhere in
//   the tree, and a history stays a leaf until it has been visited as often as there are actions. Where no estimate is good
//   enough, or there is a rollout policy, a new history starts with a rollout. The root's values are drawn towards that
//   order as far as they do not contradict it (prior_values.hpp).
// - Where the states are few, told apart by all that is in them, simulations step by a table of the model and not by the
//   documents' code (step_table.hpp).
// - The exploration bonus of an action follows the spread of its own returns: immediate rewards say little about it, and a
//   constant that is too small is the commonest way for POMCP to fail. It falls polynomially, not logarithmically, as
//   values that drift while the tree below them grows need (Shah, Xie and Xu, 2020).
// - Where new histories are valued by rollouts, the actions that a rollout would take have most of the exploration. The paper
//   gives them visits and values that the document's author would have to know.
// - Values are backed up through the best action among those with a quarter of the visits of the most visited one, not as
//   the mean of all simulations, which the exploring ones pull down. The decision is made in the same way.
// - Every eighth simulation takes the root's actions in turn, so that the values of all of them are worth reading.
// - After a real step the subtree below (action, observation) is kept and looks the full horizon ahead again.
// - With several threads each has a tree of its own; values are merged by visits. With a budget in simulations each thread
//   has its fixed share of them, so that a seed gives the same result however the threads are scheduled.
// - A budget in time is not used up once the choice cannot change; see TreeSearch::is_decided.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/mdp_values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/learned_values.hpp"
#include "aos/planning/prior_values.hpp"
#include "aos/planning/simulated_state.hpp"
#include "aos/planning/tree_search.hpp"

namespace aos {

inline constexpr std::size_t max_search_bytes = std::size_t{1} << 30;  // for the trees of all threads
inline constexpr double least_time_share = 0.1;  // of a budget in time that is always used
inline constexpr std::size_t max_prior_steps = 20'000;

template <class Model>
class Pomcp {
 public:
  using State = typename Model::State;

  Pomcp(const StateSpace<Model>& space, MdpValues<Model>& values) : space_(space), values_(values) {}

  // Runs the search and returns how many simulations it took.
  std::uint64_t search(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred = {}) {
    return search(belief, budget, horizon, random, barred, -1, [] { return false; });
  }

  // Looks ahead below one action while it is carried out, until `is_over()`, which is asked every millisecond or so.
  template <class IsOver>
  std::uint64_t ponder(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                            IsOver&& is_over) {
    return search(belief, budget, horizon, random, {}, action, is_over);
  }

  // For each action; values are over the whole belief, so that its ended part counts as nothing to gain.
  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    std::vector<ActionEstimate> result(static_cast<std::size_t>(Model::action_count()));
    const double running = belief.probability_of(Ending::running);
    for (int a = 0; a < Model::action_count(); ++a) {
      double n = 0;
      double q = 0;
      double squares = 0;
      double reward = 0;
      for (const auto& tree : trees_) {
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
    if (prior_.empty()) return result;
    std::uint32_t most = 0;
    for (const ActionEstimate& estimate : result) most = std::max(most, estimate.n);
    draw_towards(prior_, result, [&](const ActionEstimate& estimate) { return is_well_visited(estimate.n, most); });
    return result;
  }
  // Whether values are drawn towards an order of the actions that was known before the search.
  bool has_prior() const { return !prior_.empty(); }
  // Whether what states are worth was learned from simulations.
  bool has_estimates() const { return has_estimates_; }

  // How many simulations went through the root.
  std::uint64_t known_simulations() const {
    std::uint64_t sum = 0;
    for (const auto& tree : trees_) sum += tree->known_simulations();
    return sum;
  }

  // Keeps what is known below the action and observation; nothing where that was never simulated.
  void move_to(int action, Observation observation) {
    for (const auto& tree : trees_) tree->move_to(action, observation);
  }
  void forget() {
    for (const auto& tree : trees_) tree->forget();
  }

 private:
  using Tree = TreeSearch<Model>;

  // What one thread has done; a fault of model code with the piece that ran.
  struct Work {
    std::uint64_t simulations = 0;
    std::exception_ptr fault;
    std::uint32_t piece = 0;
  };

  template <class IsOver>
  std::uint64_t search(const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                       const BarredActions& barred, int first, IsOver&& is_over) {
    const bool has_values = values_.prepare(belief, horizon);
    const MdpValues<Model>* const values = has_values ? &values_ : nullptr;
    const bool may_estimate = !has_values && !Model::has_rollout_policy;
    const LearnedValues<Model>* const estimates =
        may_estimate && estimates_.prepare(belief, horizon, random) ? &estimates_ : nullptr;
    const auto start = PlanningClock::now();
    const auto worth = [&](const State& state) { return ComputedState<Model>{state, values, estimates}.value(horizon); };
    mdp_value_ = has_values || estimates != nullptr ? mean_value(belief, worth) : 0;
    const auto threads = static_cast<std::size_t>(budget.threads);
    if (trees_.size() != threads) {
      trees_.clear();
      for (std::size_t i = 0; i < threads; ++i) trees_.push_back(std::make_unique<Tree>(max_search_bytes / threads));
    }
    prior_.clear();
    if (belief.probability_of(Ending::running) <= 0) return 0;
    has_estimates_ = estimates != nullptr;
    if (has_estimates_) prior_ = estimated_prior(belief, horizon, random);
    if (has_values && space_.leaves_out_observations()) prior_ = listed_prior(belief);
    for (const auto& tree : trees_) tree->begin(horizon, prior_, barred);
    if (has_values && steps_.prepare(space_, belief)) {
      const auto start_state = [&](Sampler& own) { return ListedState<Model>{steps_, values_, own}; };
      return simulate_all(start_state, budget, start, random, first, is_over);
    }
    const auto start_state = [&](Sampler& own) { return ComputedState<Model>{belief.sample(own), values, estimates}; };
    return simulate_all(start_state, budget, start, random, first, is_over);
  }

  // `start_state(random)` is a state of the belief, as of simulated_state.hpp.
  template <class StartState, class IsOver>
  std::uint64_t simulate_all(StartState&& start_state, Budget budget, PlanningClock::time_point start, Sampler& random,
                             int first, IsOver&& is_over) {
    const std::size_t threads = trees_.size();
    std::vector<Work> works(threads);
    {
      std::vector<std::jthread> others;
      for (std::size_t i = 1; i < threads; ++i) {
        const std::uint64_t seed = random.bits();
        others.emplace_back([&, i, seed] {
          blame::use_line(static_cast<int>(i));
          Sampler own{seed};
          works[i] = work(*trees_[i], start_state, share(budget, i), start, own, first, is_over);
        });
      }
      works[0] = work(*trees_[0], start_state, share(budget, 0), start, random, first, is_over);
    }
    std::uint64_t simulations = 0;
    for (const Work& done : works) {
      if (done.fault) {
        blame::at(done.piece);
        std::rethrow_exception(done.fault);
      }
      simulations += done.simulations;
    }
    return simulations;
  }

  static Budget share(Budget budget, std::size_t thread) {
    const auto threads = static_cast<std::uint64_t>(budget.threads);
    if (budget.simulations > 0) budget.simulations = budget.simulations / threads + (thread < budget.simulations % threads);
    return budget;
  }

  template <class StartState, class IsOver>
  static Work work(Tree& tree, const StartState& start_state, Budget budget, PlanningClock::time_point start,
                   Sampler& random, int first, IsOver&& is_over) {
    constexpr std::uint64_t between_looks = 64;
    Work done;
    try {
      const bool has_limit = budget.simulations > 0 || budget.seconds <= 0;
      while (!has_limit || done.simulations < budget.simulations) {
        if (done.simulations % between_looks == 0) {
          if (is_over() || (budget.seconds > 0 && is_enough(tree, budget.seconds, start, done.simulations, first))) break;
        }
        ++done.simulations;
        auto state = start_state(random);
        if (!state.has_ended()) tree.simulate(state, first, random);
      }
    } catch (...) {
      done.fault = std::current_exception();
      done.piece = blame::piece();
    }
    blame::at(0);
    return done;
  }

  static bool is_enough(const Tree& tree, double seconds, PlanningClock::time_point start, std::uint64_t simulations,
                        int first) {
    const double spent = std::chrono::duration<double>(PlanningClock::now() - start).count();
    if (spent >= seconds) return true;
    if (first >= 0 || spent < least_time_share * seconds) return false;
    return tree.is_decided(static_cast<double>(simulations) * (seconds / spent - 1));
  }

  // What the running part of a belief is worth on average.
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

  // How much less each action is worth than the best one, on average over some states of the belief, each with the same
  // luck for all actions.
  std::vector<double> estimated_prior(const Belief<Model>& belief, int horizon, Sampler& random) const {
    std::vector<double> prior(static_cast<std::size_t>(Model::action_count()));
    const auto states = std::clamp<std::size_t>(max_prior_steps / prior.size(), 20, 500);
    for (std::size_t i = 0; i < states; ++i) {
      const State& state = belief.sample(random);
      const Sampler luck{random.bits()};
      if (Model::ending(state) != Ending::running) continue;
      for (int a = 0; a < Model::action_count(); ++a) {
        prior[static_cast<std::size_t>(a)] += estimates_.action_value(state, a, horizon, luck) / static_cast<double>(states);
      }
    }
    return below_best(std::move(prior));
  }
  std::vector<double> listed_prior(const Belief<Model>& belief) const {
    std::vector<double> prior(static_cast<std::size_t>(Model::action_count()));
    for (const auto& [number, weight] : space_.weights_of(belief)) values_.add_action_values(number, prior, weight);
    return below_best(std::move(prior));
  }
  static std::vector<double> below_best(std::vector<double> worths) {
    const double best = *std::max_element(worths.begin(), worths.end());
    for (double& worth : worths) worth = best - worth;
    return worths;
  }

  std::vector<std::unique_ptr<Tree>> trees_;
  const StateSpace<Model>& space_;
  MdpValues<Model>& values_;
  StepTable<Model> steps_;
  LearnedValues<Model> estimates_;
  std::vector<double> prior_;  // of the last search
  bool has_estimates_ = false;
  double mdp_value_ = 0;
};

}  // namespace aos
