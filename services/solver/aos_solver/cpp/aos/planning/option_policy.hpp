// Decides where the states cannot be listed: which option to take, or what to find out before.
//
// A few states of the belief stand for it. Options are ways to what can be earned from one of them (option_search.hpp).
// What the best options earn by the weights of the states is what the robot earns if it observes nothing more. Where the
// state is seen they earn more, and the difference is the regret of not knowing it. So an observation is worth the regret
// that it takes away. The robot does what has the highest sum of what is earned on the way and what the seen states are worth
// after it, less the regret that is left. It may
//
//   take an option;
//   observe, once or several times in a row (blinkered value of information: Hay, Russell, Tolpin and Shimony, 2012);
//   move, and observe on the way or where it leads.
//
// Where some actions only observe, half of the regret counts, since more can be observed later.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/option_gains.hpp"
#include "aos/planning/option_library.hpp"
#include "aos/planning/option_search.hpp"
#include "aos/planning/repeated_observation.hpp"
#include "aos/planning/sampled_belief.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/step_reports.hpp"

namespace aos {

template <class Model>
class OptionPolicy {
 public:
  using State = typename Model::State;

  // Draws states and finds options. Returns why this policy cannot decide; empty if it can.
  std::string prepare(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    if (belief.probability_of(Ending::running) <= 0) return "the mission is over";
    if (!obstacle_.empty()) return obstacle_;
    const ForgottenTexts forgotten;
    if (!is_prepared_) library_.prepare(belief, random);
    const double affordable = affordable_steps(budget, horizon);
    const auto states = std::clamp<double>(of_states * affordable / Model::action_count(), 16, 64);
    belief_.draw(belief, static_cast<std::size_t>(states), random);
    library_.drop_unused(gains_);
    double left = of_options * affordable;
    const double found = library_.extend(belief_, left, random);
    gains_.measure(library_.options(), belief_.states(), library_.cells(), left, random);
    steps_ = of_options * affordable - left;
    std::string obstacle = found < enough_found ? "no way to a reward is found from most states" : "";
    if (!is_prepared_ && obstacle.empty()) obstacle_ = obstacle = obstacle_of_model(random);
    is_prepared_ = is_prepared_ || obstacle.empty();
    return obstacle;
  }

  // Decides for the belief of `prepare`. Returns the work as simulations.
  std::uint64_t search(const Belief<Model>& belief, int horizon, Sampler& random, const BarredActions& barred) {
    const ForgottenTexts forgotten;
    barred_ = barred;
    candidates_.clear();
    seen_.clear();
    for (std::size_t k = 0; k < belief_.size(); ++k) seen_.push_back(gains_.best_in(k));
    value_seen_ = mean(seen_);
    regret_ = regret_of(belief_.weights());
    observe_all(random);
    share_left_ = tests_.empty() ? 1 : learned_later;
    const std::vector<std::size_t> likely = likely_options();
    for (const std::size_t option : likely) add_option(option);
    add_tests(random);
    add_moves(random);
    for (const std::size_t option : likely) {
      if (library_.options()[option].size() > 1) add_view(library_.options()[option].front(), random);
    }
    settle(belief.probability_of(Ending::running));
    return 1 + static_cast<std::uint64_t>(steps_ / horizon);
  }

  const std::vector<ActionEstimate>& estimates() const { return estimates_; }
  // What decided, for a plan's `why`.
  const char* reason() const { return reason_; }

  void start_over() {
    is_prepared_ = false;
    obstacle_.clear();
    gains_ = {};
  }

 private:
  static constexpr double least_steps = 100'000;
  static constexpr double of_options = 0.4;  // of the affordable steps
  static constexpr double of_states = 0.05;
  static constexpr double enough_found = 0.5;   // of the belief
  static constexpr double most_touching = 0.5;  // of pairs of options
  static constexpr double learned_later = 0.5;  // the share of the regret that counts, where something only observes
  static constexpr std::size_t tried_options = 8;
  static constexpr std::size_t tried_tests = 8;  // of each skill
  static constexpr int observations = 16;        // drawn of each way
  static constexpr int most_repeats = 8;
  static constexpr std::size_t few_moves = 16;  // each is tried several times in a row
  static constexpr std::size_t valued_states = 12;
  static constexpr int tries = 8;                    // of a way from a next state
  static constexpr double value_steps = 20'000;      // to find ways from a next state
  static constexpr double least_information = 1e-3;  // in nats

  struct Candidate {
    int action;
    double value;
    const char* reason;
  };
  struct Test {
    int action;
    double reward;
    double information;
  };

  // How many steps of the model fit the budget.
  double affordable_steps(Budget budget, int horizon) {
    constexpr double operations_of_second = 1e9;
    if (budget.simulations > 0) return std::max(static_cast<double>(budget.simulations) * horizon, least_steps);
    if (step_cost_ == 0) step_cost_ = std::max(cost_of_step<Model>(), operations_of_step);
    return std::max(budget.seconds * operations_of_second / static_cast<double>(step_cost_), least_steps);
  }

  // What keeps the policy from deciding in this model.
  std::string obstacle_of_model(Sampler& random) {
    if (gains_.touching() > most_touching) return "most ways to a reward change the same variables";
    barred_ = {};
    observe_all(random);
    return tests_.empty() && moves_.size() > few_moves ? "nothing is observed but by what changes the state" : "";
  }

  double mean(const std::vector<double>& values) const {
    double sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += belief_.weights()[k] * values[k];
    return sum;
  }
  double regret_of(const StateWeights& weights) const {
    double seen = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) seen += weights[k] * seen_[k];
    return std::max(seen - gains_.best(weights), 0.0);
  }
  bool is_barred(int action) const { return barred_.contains(static_cast<std::size_t>(action)); }

  // --- options -------------------------------------------------------------------------------------------

  // Those with the highest income by the belief.
  std::vector<std::size_t> likely_options() const {
    std::vector<std::pair<double, std::size_t>> incomes;
    for (std::size_t o = 0; o < gains_.size(); ++o) {
      const Option& option = library_.options()[o];
      if (!is_barred(option.front())) incomes.emplace_back(income<Model>(gains_.earned(o, belief_.weights()), option.size()), o);
    }
    std::ranges::stable_sort(incomes, std::greater<>{}, [](const auto& entry) { return entry.first; });
    std::vector<std::size_t> options;
    for (std::size_t i = 0; i < std::min(tried_options, incomes.size()); ++i) options.push_back(incomes[i].second);
    return options;
  }

  void add_option(std::size_t option) {
    const StateWeights after = gains_.after(option, belief_.weights());
    double seen = 0;
    for (std::size_t k = 0; k < after.size(); ++k) seen += after[k] > 0 ? after[k] * gains_.best_in(k, option) : 0;
    const double later = seen - share_left_ * (seen - gains_.best(after, option));
    const double value = gains_.earned(option, belief_.weights()) + gains_.discount(option) * later;
    candidates_.push_back({library_.options()[option].front(), value, "what can be earned"});
  }

  // --- observations --------------------------------------------------------------------------------------

  // Takes each action once from each state, and notes what is observed.
  void observe_all(Sampler& random) {
    const auto actions = static_cast<std::size_t>(Model::action_count());
    reports_.resize(actions);
    informations_.assign(actions, 0);
    tests_.clear();
    moves_.clear();
    std::vector<std::uint64_t> before(library_.cells().size()), after(before);
    for (std::size_t a = 0; a < actions; ++a) {
      reports_[a].resize(belief_.size());
      if (is_barred(static_cast<int>(a))) continue;
      bool changes = false;
      double reward = 0;
      for (std::size_t k = 0; k < belief_.size(); ++k) {
        State state = belief_.states()[k];
        library_.cells().write(state, before.data());
        reward += belief_.weights()[k] * step_.take(state, static_cast<int>(a), reports_[a][k], random);
        library_.cells().write(state, after.data());
        changes = changes || before != after || Model::ending(state) != Ending::running;
      }
      steps_ += 2 * static_cast<double>(belief_.size());
      if (changes) {
        moves_.push_back(static_cast<int>(a));
        continue;
      }
      informations_[a] = information(belief_.weights(), reports_[a], observations, random);
      if (informations_[a] > least_information) tests_.push_back({static_cast<int>(a), reward, informations_[a]});
    }
    std::ranges::stable_sort(tests_, std::greater<>{}, &Test::information);
  }

  void add_tests(Sampler& random) {
    std::vector<std::size_t> tried(static_cast<std::size_t>(Model::skill_count));
    for (const Test& test : tests_) {
      if (tried[static_cast<std::size_t>(Model::skill_of(test.action))]++ >= tried_tests) continue;
      const std::vector<StepReports>& reports = reports_[static_cast<std::size_t>(test.action)];
      const RepeatedObservation observation{reports};
      double paid = 0;
      double discount = 1;
      for (int repeats = 1, done = 0; repeats <= most_repeats; repeats *= 2) {
        for (; done < repeats; ++done, discount *= Model::discount) paid += discount * test.reward;
        const double left = regret_after(observation, repeats, random, [&](std::size_t k, StateWeights& weights) {
          for (int i = 0; i < repeats; ++i) observe(reports, reports[k].drawn(random), weights);
        });
        candidates_.push_back({test.action, paid + discount * (value_seen_ - share_left_ * left), "what can be observed"});
      }
    }
  }

  // The mean regret after an observation that is made so many times. Where these are too many to list, `see(k, weights)`
  // draws from state k what is observed.
  template <class See>
  double regret_after(const RepeatedObservation& observation, int times, Sampler& random, See&& see) {
    double sum = 0;
    if (observation.is_listed(times)) {
      observation.for_each(belief_.weights(), times, [&](double probability, const StateWeights& weights) { sum += probability * regret_of(weights); });
      return sum;
    }
    draw_states(belief_.weights(), observations, random, [&](std::size_t k) {
      StateWeights weights = belief_.weights();
      see(k, weights);
      sum += regret_of(weights);
    });
    return sum / observations;
  }

  // --- moves ---------------------------------------------------------------------------------------------

  void add_moves(Sampler& random) {
    if (moves_.size() > few_moves) return;
    for (const int move : moves_) {
      for (int repeats = 1; repeats <= most_repeats; repeats *= 2) add_way(Option(static_cast<std::size_t>(repeats), move), random);
    }
  }

  // Adds a move with what can best be observed after it, and not before.
  void add_view(int move, Sampler& random) {
    std::vector<State> now = belief_.states();
    std::vector<StepReports> reports(now.size());
    for (State& state : now) step_.take(state, move, reports.front(), random);
    int best = -1;
    double most = least_information;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (is_barred(action) || std::ranges::find(moves_, action) != moves_.end()) continue;
      for (std::size_t k = 0; k < now.size(); ++k) {
        State state = now[k];
        step_.take(state, action, reports[k], random);
      }
      steps_ += 2 * static_cast<double>(now.size());
      const double gained = information(belief_.weights(), reports, observations, random) - informations_[static_cast<std::size_t>(action)];
      if (gained <= most) continue;
      most = gained;
      best = action;
    }
    if (best >= 0) add_way({move, best}, random);
  }

  // Adds actions in a row, where at least half of the missions go on after them.
  void add_way(const Option& way, Sampler& random) {
    std::vector<State> now = belief_.states();
    std::vector<std::vector<StepReports>> reports(way.size(), std::vector<StepReports>(now.size()));
    const auto goes_on = [&](std::size_t k) { return Model::ending(now[k]) == Ending::running; };
    double earned = 0;
    double discount = 1;
    for (std::size_t step = 0; step < way.size(); ++step, discount *= Model::discount) {
      for (std::size_t k = 0; k < now.size(); ++k) {
        if (goes_on(k)) earned += discount * belief_.weights()[k] * step_.take(now[k], way[step], reports[step][k], random);
      }
    }
    steps_ += 2 * static_cast<double>(now.size() * way.size());
    double share = 0;
    for (std::size_t k = 0; k < now.size(); ++k) share += goes_on(k) ? belief_.weights()[k] : 0;
    if (share < 0.5) return;
    const RepeatedObservation last{share < 1 - 1e-9 || !tell_nothing(reports) ? std::vector<StepReports>{} : reports.back()};
    const double left = regret_after(last, 1, random, [&](std::size_t k, StateWeights& weights) {
      for (std::size_t i = 0; i < now.size(); ++i) weights[i] *= goes_on(i) ? 1 : 0;
      if (weights[k] <= 0) return;
      for (const auto& of_step : reports) observe(of_step, of_step[k].drawn(random), weights);
    });
    // What is at stake grows as the mission comes closer to what it can earn.
    const double seen = share * (value_seen_ + gain_of(now, random));
    const double stake = value_seen_ > 0 ? std::max(seen / value_seen_, 0.0) : 1;
    candidates_.push_back({way.front(), earned + discount * (seen - share_left_ * stake * left), "what can be observed elsewhere"});
  }

  // Whether nothing is observed on the way but at its last step.
  static bool tell_nothing(const std::vector<std::vector<StepReports>>& reports) {
    return std::all_of(reports.begin(), reports.end() - 1, [](const auto& of_step) { return RepeatedObservation{of_step}.tells_nothing(); });
  }

  // How much more the next states are worth than those before, if they are seen.
  double gain_of(const std::vector<State>& now, Sampler& random) {
    double gain = 0;
    double count = 0;
    const std::size_t stride = std::max<std::size_t>(now.size() / valued_states, 1);
    for (std::size_t k = stride / 2; k < now.size(); k += stride) {
      if (Model::ending(now[k]) != Ending::running) continue;
      gain += value_of(now[k], random) - seen_[k];
      ++count;
    }
    return count > 0 ? gain / count : 0;
  }
  double value_of(State state, Sampler& random) {
    OptionSearch<Model> search{library_.cells()};
    double value = 0;
    double discount = 1;
    double left = value_steps;
    while (Model::ending(state) == Ending::running && left > 0) {
      const std::vector<Option> ways = search.from(state, left, random);
      if (ways.empty()) break;
      State next = state;
      double earned = 0;
      for (int i = 0; i < tries; ++i) {
        next = state;
        earned += taken_option<Model>(ways.front(), next, random).earned / tries;
      }
      state = std::move(next);
      value += discount * earned;
      discount *= std::pow(Model::discount, ways.front().size());
    }
    steps_ += value_steps - left;
    return value;
  }

  // --- the decision ----------------------------------------------------------------------------------------

  void settle(double running) {
    estimates_.assign(static_cast<std::size_t>(Model::action_count()), {});
    const Candidate* best = nullptr;
    for (const Candidate& candidate : candidates_) {
      if (best == nullptr || candidate.value > best->value) best = &candidate;
      ActionEstimate& estimate = estimates_[static_cast<std::size_t>(candidate.action)];
      const double value = running * candidate.value;
      if (estimate.n == 0 || value > estimate.q) estimate.q = value;
      estimate.n = static_cast<std::uint32_t>(belief_.size());
      estimate.standard_error = running * regret_ / 2;
    }
    reason_ = best != nullptr ? best->reason : "nothing";
  }

  bool is_prepared_ = false;
  std::string obstacle_;
  OptionLibrary<Model> library_;
  OptionGains<Model> gains_;
  ReportedStep<Model> step_;
  // Of the last decision:
  SampledBelief<Model> belief_;
  std::vector<double> seen_;  // what the states are worth if they are seen
  double value_seen_ = 0;
  double regret_ = 0;
  double share_left_ = 1;
  double steps_ = 0;
  Operations step_cost_ = 0;  // 0: not known yet
  BarredActions barred_;
  std::vector<std::vector<StepReports>> reports_;  // [action][state]
  std::vector<double> informations_;               // by action
  std::vector<Test> tests_;
  std::vector<int> moves_;
  std::vector<Candidate> candidates_;
  std::vector<ActionEstimate> estimates_;
  const char* reason_ = "";
};

}  // namespace aos
