// What can be observed elsewhere: moves, with what is observed on the way or where they lead.
#pragma once

#include "aos/planning/budget.hpp"
#include "aos/planning/options/later_costs.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/option_tests.hpp"
#include "aos/planning/options/option_values.hpp"
#include "aos/planning/options/repeated_observation.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

template <class Model>
class OptionMoves {
 public:
  using State = typename Model::State;
  static constexpr std::size_t few = 16;  // each is tried several times in a row

  OptionMoves(const SampledBelief<Model>& belief, const OptionRegret<Model>& regret, const OptionTests<Model>& tests,
              const OptionValues<Model>& values, const LaterCosts<Model>& later)
      : belief_(belief), regret_(regret), tests_(tests), values_(values), later_(later) {}

  // Adds each of the moves, once or several times in a row, the latter while there are steps.
  void add_to(List<OptionCandidate>& candidates, const List<int>& moves, double& steps, Sampler& random) {
    for (int repeats = 1; repeats <= OptionTests<Model>::most_repeats; repeats *= 2) {
      for (const int move : moves) {
        if (repeats == 1 || (steps > 0 && !tests_.clock().is_over())) add_way(candidates, Option(static_cast<std::size_t>(repeats), move), steps, random);
      }
    }
  }

  // A move with the test that can best be made after it, and not before: what they earn, and what the test tells, in nats.
  struct View {
    int move;
    int test = -1;  // none
    double reward = 0;
    double information = 0;
  };

  View best_view(int move, const BarredActions& barred, double& steps, Sampler& random) {
    List<State> now = belief_.states();
    List<StepReports> reports(now.size());
    const double paid = belief_.mean([&](std::size_t k) { return step_.take(now[k], move, reports.front(), steps, random); });
    View best{move};
    double most = OptionTests<Model>::least_information;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (barred.contains(action) || tests_.is_move(action)) continue;
      if (tests_.clock().is_over()) break;
      double reward = paid;
      for (std::size_t k = 0; k < now.size(); ++k) {
        State state = now[k];
        reward += belief_.weights()[k] * step_.take(state, action, reports[k], steps, random);
      }
      steps -= OptionTests<Model>::steps_of_weighing(now.size());
      const double told = information(belief_.weights(), reports, random);
      const double gained = told - tests_.information_of(action);
      if (gained <= most) continue;
      most = gained;
      best = {move, action, reward, told};
    }
    return best;
  }

  // Adds such a move.
  void add_view(List<OptionCandidate>& candidates, const View& view, double& steps, Sampler& random) {
    if (view.test >= 0) add_way(candidates, {view.move, view.test}, steps, random);
  }

  // How much of the regret an observation spares after one of the likely options, but for what it tells of that option; as much as `here` for a test that
  // tells the same there.
  double spared_after(const Option& option, std::size_t likely, const Option& way, double here, double& steps, Sampler& random) {
    List<State> now = belief_.states();
    StateWeights start = belief_.weights();
    double share = 0;
    for (std::size_t k = 0; k < now.size(); ++k) {
      start[k] *= taken_option<Model>(option, now[k], random, nullptr).goes_on;
      share += start[k];
    }
    steps -= option.size() * now.size();
    if (share <= 0) return 0;
    for (double& weight : start) weight /= share;
    List<List<StepReports>> reports(way.size(), List<StepReports>(now.size()));
    for (std::size_t step = 0; step < way.size(); ++step) {
      for (std::size_t k = 0; k < now.size(); ++k) {
        if (start[k] > 0 && Model::ending(now[k]) == Ending::running) step_.take(now[k], way[step], reports[step][k], steps, random);
      }
    }
    steps -= way.size() * OptionTests<Model>::steps_of_weighing(now.size());
    const bool is_repeated = !tests_.is_move(way.front()) && std::ranges::count(way, way.front()) == std::ssize(way);
    if (is_repeated && tells_alike(reports.front(), tests_.reports_of(way.front()))) return here;
    const auto last = is_repeated ? RepeatedObservation{reports.front()} : RepeatedObservation::at_last(reports);
    const auto told = regret_.after(last, is_repeated ? static_cast<int>(way.size()) : 1, start, steps, random, [&](std::size_t k, StateWeights& weights) {
      for (const auto& of_step : reports) {
        if (!of_step[k].branches().empty()) observe(of_step, of_step[k].drawn(random), weights);
      }
    });
    return regret_.after(start) - told.regret - told.avoided[likely];
  }

 private:
  // Whether a test tells the same, as far as the mission goes on.
  static bool tells_alike(const List<StepReports>& there, const List<StepReports>& here) {
    return std::ranges::equal(there, here, [](const StepReports& one, const StepReports& other) { return one.branches().empty() || one.is_like(other); });
  }
  // Adds actions in a row, where at least half of the missions go on after them.
  void add_way(List<OptionCandidate>& candidates, const Option& way, double& steps, Sampler& random) {
    List<State> now = belief_.states();
    List<List<StepReports>> reports(way.size(), List<StepReports>(now.size()));
    const auto goes_on = [&](std::size_t k) { return Model::ending(now[k]) == Ending::running; };
    double earned = 0;
    double discount = 1;
    for (std::size_t step = 0; step < way.size(); ++step, discount *= Model::discount) {
      for (std::size_t k = 0; k < now.size(); ++k) {
        if (goes_on(k)) earned += discount * belief_.weights()[k] * step_.take(now[k], way[step], reports[step][k], steps, random);
      }
    }
    const double share = belief_.mean(goes_on);
    if (share < 0.5) return;
    earned += belief_.mean([&](std::size_t k) { return later_.of(way.size(), belief_.states()[k], now[k], random); });
    steps -= LaterCosts<Model>::steps_of_looking * now.size();
    const auto last = share < 1 - 1e-9 ? RepeatedObservation{List<StepReports>{}} : RepeatedObservation::at_last(reports);
    if (!last.is_listed(1)) steps -= way.size() * OptionTests<Model>::steps_of_weighing(now.size());
    const auto told = regret_.after(last, 1, belief_.weights(), steps, random, [&](std::size_t k, StateWeights& weights) {
      for (std::size_t i = 0; i < now.size(); ++i) weights[i] *= goes_on(i) ? 1 : 0;
      if (weights[k] <= 0) return;
      for (const auto& of_step : reports) observe(of_step, of_step[k].drawn(random), weights);
    });
    // What is at stake grows as the mission comes closer to what it can earn.
    const double seen = share * (regret_.value_seen() + values_.gain_of(now, way.size(), steps, random));
    const double stake = regret_.value_seen() > 0 ? std::max(seen / regret_.value_seen(), 0.0) : 1;
    candidates.push_back({way.front(), earned + discount * (seen - stake * told.regret), discount, "what can be observed elsewhere", told.avoided,
                          way, regret_.now() - told.regret});
    if (share > 1 - 1e-9) candidates.back().reports = std::move(reports);
  }

  const SampledBelief<Model>& belief_;
  const OptionRegret<Model>& regret_;
  const OptionTests<Model>& tests_;
  const OptionValues<Model>& values_;
  const LaterCosts<Model>& later_;
  ReportedStep<Model> step_;
};

}
