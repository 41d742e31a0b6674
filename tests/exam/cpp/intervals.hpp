// Values and margins that searches tell with their standard errors, and where they change, held against the truth.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/planning/planner.hpp"
#include "aos/text/json.hpp"
#include "belief_line.hpp"
#include "flat.hpp"
#include "problem.hpp"
#include "table_model.hpp"
#include "truth.hpp"

namespace exam {

// The shares of a decision's budget that `aos why` searches with: for an action alone, and for it at another probability.
inline constexpr double share_alone = 1.0 / 2;
inline constexpr double share_beside = 1.0 / 13;

struct IntervalOptions {
  std::uint64_t seed = 1;
  std::uint64_t simulations = 5000;
  double truth_seconds = 0.5;  // for the bracket of an action
  int steps = 3;               // of the walk along which decisions are made
};

// What a search tells of an action that has a share of the simulations for itself.
inline aos::ActionEstimate value_alone(const aos::Belief<TableModel>& belief, int action, aos::Budget budget, double share,
                                       int horizon, aos::Sampler& random) {
  aos::BarredActions others;
  for (int other = 0; other < TableModel::action_count(); ++other) {
    if (other != action) others.insert(static_cast<std::size_t>(other));
  }
  budget.simulations = std::max<std::uint64_t>(std::llround(static_cast<double>(budget.simulations) * share), 1);
  aos::Planners<TableModel> planner;
  planner.search(aos::PlannerKind::pomcp, belief, budget, horizon, random, others);
  return planner.values(belief, planner.estimates(belief), action)[action];
}

// The best of the actions that were not chosen; -1 if none was tried.
inline int runner_up(const aos::List<aos::ActionEstimate>& told, int chosen) {
  int other = -1;
  for (int action = 0; action < static_cast<int>(told.size()); ++action) {
    if (action == chosen || told[action].n == 0) continue;
    if (other < 0 || told[action].q > told[other].q) other = action;
  }
  return other;
}

// A decision and two of its actions.
struct DecidedCase {
  const Problem& problem;
  const aos::Belief<TableModel>& belief;
  const Mass& exact;
  int chosen;
  int other;
};

// Writes where the choice changes if a value is moved: its probability now, the probabilities beside it, each with what
// searches tell of both actions there, whether the truth is known, and between which probabilities the exact choice changes.
inline void write_line(aos::JsonWriter& json, const DecidedCase& decided, Truth& truth, const Flat& flat,
                       const IntervalOptions& options, aos::Sampler& random) {
  const BeliefLine line{decided.problem, decided.exact};
  json.begin_array();
  if (line.is_open() && decided.belief.probability_of(aos::Ending::running) > 1 - 1e-9) {
    const aos::Budget budget{.simulations = options.simulations};
    json.value(line.now()).begin_array();
    for (const double place : {0.0, line.now() / 2, (1 + line.now()) / 2, 1.0}) {
      const aos::Belief<TableModel> moved = line.moved(decided.belief, place);
      json.begin_array().value(place);
      for (const int action : {decided.chosen, decided.other}) {
        const aos::ActionEstimate alone = value_alone(moved, action, budget, share_beside, decided.problem.horizon, random);
        json.value(alone.q).value(alone.standard_error);
      }
      json.end_array();
    }
    const Changes changes = line.changes(truth, flat, static_cast<std::size_t>(decided.chosen),
                                         static_cast<std::size_t>(decided.other), options.truth_seconds / 10);
    json.end_array().value(changes.is_known).begin_array();
    for (const auto& [low, high] : changes.between) json.begin_array().value(low).value(high).end_array();
    json.end_array();
  }
  json.end_array();
}

// Decides by POMCP along a random walk. Each decision is a case: of the chosen action and of the best of the others the
// value that is told, its standard error, the bracket of the truth, and what a search of this action alone tells; then the
// line of beliefs.
inline std::string intervals_of(const Problem& problem, const IntervalOptions& options) {
  using Belief = aos::Belief<TableModel>;
  TableModel::take(problem);
  const Flat flat{problem, true};
  const Flat plain{problem, false};
  Truth truth{flat, problem.horizon};
  aos::Sampler random{options.seed};
  Belief belief = Belief::initial(random);
  Mass exact = flat.start().first;
  aos::Planners<TableModel> planner;
  aos::JsonWriter json;
  json.begin_object().member("problem", problem.name).key("cases").begin_array();
  for (int step = 0; step < options.steps && !exact.empty(); ++step) {
    const aos::Budget budget{.simulations = options.simulations};
    planner.search(aos::PlannerKind::pomcp, belief, budget, problem.horizon, random);
    const aos::List<aos::ActionEstimate> estimates = planner.estimates(belief);
    const int chosen = planner.choice(belief, estimates, {});
    const aos::List<aos::ActionEstimate> told = planner.values(belief, estimates, chosen);
    const int other = runner_up(told, chosen);
    if (other >= 0) {
      const double running = belief.probability_of(aos::Ending::running);
      json.begin_array();
      for (const int action : {chosen, other}) {
        const auto number = static_cast<std::size_t>(action);
        truth.narrow_action(exact, number, problem.horizon, 1e-5 * flat.largest_reward(), options.truth_seconds);
        const Bracket bracket = truth.action_value(exact, number, problem.horizon);
        const aos::ActionEstimate alone = value_alone(belief, action, budget, share_alone, problem.horizon, random);
        json.begin_array().value(told[number].q).value(told[number].standard_error);
        json.value(running * bracket.lower).value(running * bracket.upper);
        json.value(alone.q).value(alone.standard_error).end_array();
      }
      write_line(json, {problem, belief, exact, chosen, other}, truth, flat, options, random);
      json.end_array();
    }
    const int walked = random.below(TableModel::action_count());
    const aos::List<Reached> reached = plain.reached(exact, static_cast<std::size_t>(walked));
    if (reached.empty()) break;
    const Reached& next = reached[random.below(static_cast<int>(reached.size()))];
    belief = posterior_of(belief, walked, next.observation, random).first;
    if (belief.particles().empty()) break;
    exact = next.belief;
    planner.move_to(walked, next.observation);
  }
  return json.end_array().end_object().text();
}

}
