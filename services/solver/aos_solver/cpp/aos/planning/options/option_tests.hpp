// What can be observed where the robot is: actions that change nothing, and what they tell of the state.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_twins.hpp"
#include "aos/planning/options/own_changes.hpp"
#include "aos/planning/options/repeated_observation.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

template <class Model>
class OptionTests {
 public:
  using State = typename Model::State;
  static constexpr double least_information = 1e-3;  // in nats
  static constexpr int most_repeats = 8;

  struct Test {
    int action;
    double reward;
    double information;
    bool is_priced;  // since it tells of nothing but the best option
  };

  // How many steps of the model take as long as to weigh so many states by what is drawn from them.
  static double steps_of_weighing(std::size_t states) {
    constexpr double of_likelihood = 0.2;
    return of_likelihood * drawn_observations * states;
  }

  OptionTests(const SampledBelief<Model>& belief, OptionRegret<Model>& regret, const OwnChanges<Model>& changes, OptionTwins<Model>& twins,
              DecisionClock& clock)
      : belief_(belief), regret_(regret), changes_(changes), twins_(twins), clock_(clock) {}

  const DecisionClock& clock() const { return clock_; }
  // Begins a mission.
  void start_over() { first_ = 0; }

  // Takes each action once from each state, and notes what is observed. `steps` is counted down. It takes half of the time that
  // is left at most, and begins next time with what is left out. Returns whether nothing was.
  bool observe_all(const BarredActions& barred, double& steps, Sampler& random) {
    const std::size_t actions = Model::action_count();
    reports_.resize(actions);
    informations_.assign(actions, 0);
    tests_.clear();
    moves_.clear();
    const DecisionClock::Slice half(clock_, clock_.left_s() / 2);
    const std::size_t first = first_;
    bool is_whole = true;
    for (std::size_t i = 0; i < actions; ++i) {
      const std::size_t a = (first + i) % actions;
      reports_[a].resize(belief_.size());
      if (barred.contains(a)) continue;
      if (changes_.is_move(a)) {
        moves_.push_back(a);
        continue;
      }
      if (clock_.is_over()) {
        if (is_whole) first_ = a;
        is_whole = false;
        continue;
      }
      const double reward = belief_.mean([&](std::size_t k) {
        State state = belief_.states()[k];
        return step_.take(state, a, reports_[a][k], steps, random);
      });
      steps -= steps_of_weighing(belief_.size());
      informations_[a] = information(belief_.weights(), reports_[a], random);
      if (informations_[a] <= least_information) continue;
      const bool is_priced = twins_.are_known() && twins_.tells_of_options(static_cast<int>(a), reports_[a], steps, random);
      tests_.push_back({static_cast<int>(a), reward, informations_[a], is_priced});
    }
    sort_stably(tests_, [](const Test& one, const Test& other) { return one.information > other.information; });
    return is_whole;
  }

  bool empty() const { return tests_.empty(); }
  const List<Test>& tests() const { return tests_; }
  // What a nat costs, with the time that it takes, by the test where it is cheapest; infinite without a test.
  double price_of_nat(double value_seen, bool of_options = false) const {
    double price = std::numeric_limits<double>::infinity();
    for (const Test& test : tests_) if (test.is_priced || !of_options) price = std::min(price, std::max((1 - Model::discount) * value_seen - test.reward, 0.0) / test.information);
    return price;
  }
  // The actions that change the state, those that are barred left out.
  const List<int>& moves() const { return moves_; }
  bool is_move(int action) const { return changes_.is_move(action); }
  // By state: what an action that is no move may report.
  const List<StepReports>& reports_of(int action) const { return reports_[action]; }
  double information_of(int action) const { return informations_[action]; }

  // Adds the tests of each skill that tell most, made once or several times in a row, the latter while there are steps. The regret
  // that is left has a price after those that tell of nothing but the best option.
  void add_to(List<OptionCandidate>& candidates, double& steps, Sampler& random) {
    const double price = twins_.are_known() ? price_of_nat(regret_.value_seen(), true) : std::numeric_limits<double>::infinity();
    const List<Test> tests = most_telling();
    for (int repeats = 1; repeats <= most_repeats && (repeats == 1 || repeats < regret_.lasts()); repeats *= 2) {
      for (const Test& test : tests) {
        if (repeats > 1 && (steps <= 0 || clock_.is_over())) continue;
        if (twins_.are_known()) regret_.set_price(test.is_priced ? price : std::numeric_limits<double>::infinity(), true);
        add(candidates, test, repeats, steps, random);
      }
    }
  }

 private:
  static constexpr std::size_t tried_tests = 8;  // of each skill

  List<Test> most_telling() const {
    List<Test> tests;
    List<std::size_t> tried(Model::skill_count);
    for (const Test& test : tests_) {
      if (tried[Model::skill_of(test.action)]++ < tried_tests) tests.push_back(test);
    }
    return tests;
  }

  void add(List<OptionCandidate>& candidates, const Test& test, int repeats, double& steps, Sampler& random) const {
    const List<StepReports>& reports = reports_[test.action];
    Earned<Model> paid;
    for (int i = 0; i < repeats; ++i) paid.add(test.reward);
    const RepeatedObservation observation{reports};
    if (!observation.is_listed(repeats)) steps -= repeats * steps_of_weighing(belief_.size());
    const auto told = regret_.after(observation, repeats, belief_.weights(), steps, random, [&](std::size_t k, StateWeights& weights) {
      for (int i = 0; i < repeats; ++i) observe(reports, reports[k].drawn(random), weights);
    });
    const double later = repeats < regret_.lasts() ? regret_.value_seen() - told.regret - regret_.lost_by(repeats) : 0;
    candidates.push_back({test.action, paid.sum + paid.discount * later, paid.discount, "what can be observed",
                          told.avoided, List<int>(static_cast<std::size_t>(repeats), test.action), regret_.now() - told.regret});
  }

  const SampledBelief<Model>& belief_;
  OptionRegret<Model>& regret_;
  const OwnChanges<Model>& changes_;
  OptionTwins<Model>& twins_;
  DecisionClock& clock_;
  ReportedStep<Model> step_;
  List<List<StepReports>> reports_;  // [action][state]
  List<double> informations_;               // by action
  List<Test> tests_;
  List<int> moves_;
  std::size_t first_ = 0;  // action that is observed
};

}
