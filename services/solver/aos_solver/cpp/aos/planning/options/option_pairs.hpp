// Whether a test comes before a move.
//
// What a test tells, and what is told where a move leads, may each be worth as much. But who leaves has to come back for what
// could be observed before. So both are weighed one after the other, in both orders: a test that is better before the best
// move is worth more than that move, by as much as the order brings. What tells the same before and after the move may wait.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/option_tests.hpp"
#include "aos/planning/options/repeated_observation.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

template <class Model>
class OptionPairs {
 public:
  using State = typename Model::State;

  OptionPairs(const SampledBelief<Model>& belief, const OptionRegret<Model>& regret, const OptionTests<Model>& tests, const DecisionClock& clock)
      : belief_(belief), regret_(regret), tests_(tests), clock_(clock) {}

  // Raises the best tests among the first candidates that come before the best of the moves. `steps` is counted down.
  void add_to(List<OptionCandidate>& candidates, std::size_t observing, double& steps, Sampler& random) {
    List<OptionCandidate*> tests;
    const OptionCandidate* move = nullptr;
    for (std::size_t c = 0; c < observing; ++c) {
      if (!tests_.is_move(candidates[c].action)) tests.push_back(&candidates[c]);
      else if (!candidates[c].reports.empty() && (move == nullptr || candidates[c].value > move->value)) move = &candidates[c];
    }
    if (move == nullptr) return;
    sort_stably(tests, [](const OptionCandidate* one, const OptionCandidate* other) { return one->value > other->value; });
    tests.resize(std::min(tests.size(), tried));
    const Telling elsewhere{move->reports, 1};
    for (OptionCandidate* test : tests) {
      if (steps <= 0 || clock_.is_over()) break;
      const int times = test->way.size();
      const Telling here{{tests_.reports_of(test->action)}, times};
      const Telling there{{reports_after(move->way, test->action, steps, random)}, times};
      if (std::ranges::equal(here.reports.front(), there.reports.front(), &StepReports::is_like)) continue;
      const double before = test->value + test->discount * gained(here, *move, elsewhere, steps, random);
      const double after = move->value + move->discount * gained(elsewhere, *test, there, steps, random);
      if (before > after) test->value = std::max(test->value, move->value + before - after);
    }
  }

 private:
  static constexpr std::size_t tried = 4;

  // What is told: by steps that are taken once, or by one that is taken several times.
  struct Telling {
    List<List<StepReports>> reports;  // [step][state]
    int times;

    RepeatedObservation listed() const { return RepeatedObservation::at_last(reports); }
    void draw(std::size_t k, StateWeights& weights, Sampler& random) const {
      for (int i = 0; i < times; ++i) {
        for (const auto& of_step : reports) observe(of_step, of_step[k].drawn(random), weights);
      }
    }
  };

  // What the second gains on average after what the first has told; nothing where it gains nothing then.
  double gained(const Telling& first, const OptionCandidate& second, const Telling& then, double& steps, Sampler& random) const {
    const double blind = regret_.value_seen() - regret_.now();
    const double alone = second.value - second.discount * (blind + second.spared);  // what it pays, and gains but for what is told
    double sum = 0;
    const auto draw = [&](std::size_t k, StateWeights& weights) { first.draw(k, weights, random); };
    after_each(first.listed(), first.times, belief_.weights(), random, draw, [&](double probability, const StateWeights& weights) {
      const double regret = regret_.after(weights);
      const double left = regret_.after(then.listed(), then.times, weights, steps, random, [&](std::size_t k, StateWeights& after) { then.draw(k, after, random); }).regret;
      const double known = regret_.value_seen(weights) - regret;
      sum += probability * std::max(alone - (1 - second.discount) * known + second.discount * (regret - left), 0.0);
    });
    return sum;
  }

  // By state: what a test may report after a move.
  List<StepReports> reports_after(const Option& way, int test, double& steps, Sampler& random) {
    List<StepReports> reports(belief_.size());
    for (std::size_t k = 0; k < belief_.size(); ++k) {
      State state = belief_.states()[k];
      taken_option<Model>(way, state, random, nullptr);
      step_.take(state, test, reports[k], steps, random);
    }
    steps -= way.size() * belief_.size();
    return reports;
  }

  const SampledBelief<Model>& belief_;
  const OptionRegret<Model>& regret_;
  const OptionTests<Model>& tests_;
  const DecisionClock& clock_;
  ReportedStep<Model> step_;
};

}
