// Values and margins that a search tells with their standard errors, held against the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/planner.hpp"
#include "flat.hpp"
#include "problem.hpp"
#include "table_model.hpp"
#include "truth.hpp"

namespace exam {

struct IntervalOptions {
  std::uint64_t seed = 1;
  std::uint64_t simulations = 5000;
  double truth_seconds = 0.5;  // for the bracket of an action
  int steps = 3;               // of the walk along which decisions are made
};

// What a search tells of an action that has all simulations for itself.
inline aos::ActionEstimate value_alone(const aos::Belief<TableModel>& belief, std::size_t action, std::size_t actions,
                                       aos::Budget budget, int horizon, aos::Sampler& random) {
  aos::BarredActions others;
  for (std::size_t other = 0; other < actions; ++other) {
    if (other != action) others.insert(other);
  }
  aos::Planners<TableModel> planner;
  planner.search(aos::PlannerKind::pomcp, belief, budget, horizon, random, others);
  return planner.values(belief, planner.estimates(belief), static_cast<int>(action))[action];
}

// Decides by POMCP along a random walk. Each decision is a case: of the chosen action and of the best of the others the
// value that is told, its standard error, the bracket of the truth, and what a search of this action alone tells.
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
    aos::Budget budget;
    budget.simulations = options.simulations;
    planner.search(aos::PlannerKind::pomcp, belief, budget, problem.horizon, random);
    const std::vector<aos::ActionEstimate> estimates = planner.estimates(belief);
    const int chosen = planner.choice(estimates);
    const std::vector<aos::ActionEstimate> told = planner.values(belief, estimates, chosen);
    int other = -1;
    for (int action = 0; action < static_cast<int>(told.size()); ++action) {
      if (action == chosen || told[action].n == 0) continue;
      if (other < 0 || told[action].q > told[other].q) other = action;
    }
    if (other >= 0) {
      const double running = belief.probability_of(aos::Ending::running);
      json.begin_array();
      for (const int action : {chosen, other}) {
        const auto number = static_cast<std::size_t>(action);
        truth.narrow_action(exact, number, problem.horizon, 1e-5 * flat.largest_reward(), options.truth_seconds);
        const Bracket bracket = truth.action_value(exact, number, problem.horizon);
        const aos::ActionEstimate alone = value_alone(belief, number, told.size(), budget, problem.horizon, random);
        json.begin_array().value(told[number].q).value(told[number].standard_error);
        json.value(running * bracket.lower).value(running * bracket.upper);
        json.value(alone.q).value(alone.standard_error).end_array();
      }
      json.end_array();
    }
    const int walked = random.below(TableModel::action_count());
    const std::vector<Reached> reached = plain.reached(exact, static_cast<std::size_t>(walked));
    if (reached.empty()) break;
    const Reached& next = reached[static_cast<std::size_t>(random.below(static_cast<int>(reached.size())))];
    belief = posterior_of(belief, walked, next.observation, random).first;
    if (belief.particles().empty()) break;
    exact = next.belief;
    planner.move_to(walked, next.observation);
  }
  return json.end_array().end_object().text();
}

}  // namespace exam
