// What can be observed elsewhere: moves, with what is observed on the way or where they lead.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/leaf_cells.hpp"
#include "aos/planning/option_regret.hpp"
#include "aos/planning/option_search.hpp"
#include "aos/planning/option_tests.hpp"
#include "aos/planning/repeated_observation.hpp"
#include "aos/planning/sampled_belief.hpp"
#include "aos/planning/step_reports.hpp"

namespace aos {

template <class Model>
class OptionMoves {
 public:
  using State = typename Model::State;
  static constexpr std::size_t few = 16;  // each is tried several times in a row

  OptionMoves(const SampledBelief<Model>& belief, const OptionRegret<Model>& regret, const OptionTests<Model>& tests,
              const LeafCells<Model>& cells)
      : belief_(belief), regret_(regret), tests_(tests), cells_(cells) {}

  // Adds each move, once or several times in a row, where they are few. `steps` is counted down.
  void add_to(std::vector<OptionCandidate>& candidates, double& steps, Sampler& random) {
    if (tests_.moves().size() > few) return;
    for (const int move : tests_.moves()) {
      for (int repeats = 1; repeats <= OptionTests<Model>::most_repeats; repeats *= 2) {
        add_way(candidates, Option(static_cast<std::size_t>(repeats), move), steps, random);
      }
    }
  }

  // Adds a move with what can best be observed after it, and not before.
  void add_view(std::vector<OptionCandidate>& candidates, int move, const BarredActions& barred, double& steps, Sampler& random) {
    std::vector<State> now = belief_.states();
    std::vector<StepReports> reports(now.size());
    for (State& state : now) step_.take(state, move, reports.front(), random);
    int best = -1;
    double most = OptionTests<Model>::least_information;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (barred.contains(static_cast<std::size_t>(action)) || tests_.is_move(action)) continue;
      for (std::size_t k = 0; k < now.size(); ++k) {
        State state = now[k];
        step_.take(state, action, reports[k], random);
      }
      steps -= 2 * static_cast<double>(now.size());
      const double told = information(belief_.weights(), reports, OptionRegret<Model>::observations, random);
      const double gained = told - tests_.information_of(action);
      if (gained <= most) continue;
      most = gained;
      best = action;
    }
    if (best >= 0) add_way(candidates, {move, best}, steps, random);
  }

 private:
  static constexpr std::size_t valued_states = 12;
  static constexpr int tries = 8;                // of a way from a next state
  static constexpr double value_steps = 20'000;  // to find ways from a next state

  // Adds actions in a row, where at least half of the missions go on after them.
  void add_way(std::vector<OptionCandidate>& candidates, const Option& way, double& steps, Sampler& random) {
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
    steps -= 2 * static_cast<double>(now.size() * way.size());
    double share = 0;
    for (std::size_t k = 0; k < now.size(); ++k) share += goes_on(k) ? belief_.weights()[k] : 0;
    if (share < 0.5) return;
    const RepeatedObservation last{share < 1 - 1e-9 || !tell_nothing(reports) ? std::vector<StepReports>{} : reports.back()};
    const double left = regret_.after(last, 1, random, [&](std::size_t k, StateWeights& weights) {
      for (std::size_t i = 0; i < now.size(); ++i) weights[i] *= goes_on(i) ? 1 : 0;
      if (weights[k] <= 0) return;
      for (const auto& of_step : reports) observe(of_step, of_step[k].drawn(random), weights);
    });
    // What is at stake grows as the mission comes closer to what it can earn.
    const double seen = share * (regret_.value_seen() + gain_of(now, steps, random));
    const double stake = regret_.value_seen() > 0 ? std::max(seen / regret_.value_seen(), 0.0) : 1;
    candidates.push_back({way.front(), earned + discount * (seen - regret_.share() * stake * left), "what can be observed elsewhere"});
  }

  // Whether nothing is observed on the way but at its last step.
  static bool tell_nothing(const std::vector<std::vector<StepReports>>& reports) {
    return std::all_of(reports.begin(), reports.end() - 1, [](const auto& of_step) { return RepeatedObservation{of_step}.tells_nothing(); });
  }

  // How much more the next states are worth than those before, if they are seen.
  double gain_of(const std::vector<State>& now, double& steps, Sampler& random) {
    double gain = 0;
    double count = 0;
    const std::size_t stride = std::max<std::size_t>(now.size() / valued_states, 1);
    for (std::size_t k = stride / 2; k < now.size(); k += stride) {
      if (Model::ending(now[k]) != Ending::running) continue;
      gain += value_of(now[k], steps, random) - regret_.value_seen(k);
      ++count;
    }
    return count > 0 ? gain / count : 0;
  }
  double value_of(State state, double& steps, Sampler& random) {
    OptionSearch<Model> search{cells_};
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
    steps -= value_steps - left;
    return value;
  }

  const SampledBelief<Model>& belief_;
  const OptionRegret<Model>& regret_;
  const OptionTests<Model>& tests_;
  const LeafCells<Model>& cells_;
  ReportedStep<Model> step_;
};

}  // namespace aos
