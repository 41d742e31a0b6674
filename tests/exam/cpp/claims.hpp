// What the engine claims of a model, held against the truth: beliefs, exact values, states that matter, bounds.
#pragma once

#include <regex>

#include "aos/belief/belief.hpp"
#include "aos/planning/planners.hpp"
#include "aos/text/json.hpp"
#include "bisimulation.hpp"
#include "flat.hpp"
#include "listed_beliefs.hpp"
#include "point_based/online.hpp"
#include "problem.hpp"
#include "table_model.hpp"
#include "truth.hpp"

namespace exam {

struct ClaimOptions {
  std::uint64_t seed = 1;
  std::uint64_t simulations = 2000;  // of a search
  double truth_seconds = 1;          // for the brackets of a problem
  int steps = 4;                     // of the walk along which beliefs are looked at
};

class Claims {
 public:
  using Belief = aos::Belief<TableModel>;
  using Planner = aos::Planners<TableModel>;

  Claims(const Problem& problem, ClaimOptions options)
      : problem_(problem), options_(options), flat_(problem, true), plain_(problem, false), random_(options.seed) {
    TableModel::take(problem);
    largest_ = std::max(flat_.largest_reward(), 1e-9);
  }

  // The report of one problem as a JSON object.
  std::string report() {
    const auto [start, running] = flat_.start();
    Belief belief = Belief::initial(random_);
    Mass exact = start;
    double known_running = running;
    Planner automatic;
    Planner point_based;
    Planner tree;
    start_tables(start);
    for (int step = 0; step <= options_.steps && !exact.empty(); ++step) {
      where_ = "step " + std::to_string(step);
      check_belief(belief, exact, known_running);
      check_exact_values(belief, exact, known_running);
      check_planner(aos::PlannerKind::automatic, automatic, belief, exact, known_running);
      check_planner(aos::PlannerKind::sarsop, point_based, belief, exact, known_running);
      check_planner(aos::PlannerKind::despot, tree, belief, exact, known_running);
      check_tables(exact);
      if (step == options_.steps) break;
      const int action = random_.below(TableModel::action_count());
      aos::List<Reached> reached = plain_.reached(exact, static_cast<std::size_t>(action));
      if (reached.empty()) break;
      const auto chosen = static_cast<std::size_t>(random_.below(static_cast<int>(reached.size())));
      const int seen = reached[chosen].observation;
      const auto [posterior, probability] = posterior_of(belief, action, seen, random_);
      const double ended = ended_and_seen(belief, exact, action, seen);
      check("posterior", probability, known_running * reached[chosen].probability + ended,
            1e-9 + belief.error_bound());
      if (posterior.particles().empty()) break;
      const double goes_on = known_running * reached[chosen].probability;
      known_running = goes_on / (goes_on + ended);
      belief = posterior;
      exact = reached[chosen].belief;
      automatic.move_to(action, seen);
      point_based.move_to(action, seen);
      tree.move_to(action, seen);
    }
    return text();
  }

 private:
  // Claims ------------------------------------------------------------

  // The belief that the mission has ended keeps its observations to itself: how likely `seen` is with an ending.
  double ended_and_seen(const Belief& belief, const Mass& exact, int action, int seen) const {
    double ended = 0;
    for (const auto& [state, weight] : belief.particles()) {
      if (state.ending != aos::Ending::running && seen == aos::default_observation) ended += weight;
    }
    const double running = belief.probability_of(aos::Ending::running);
    for (const auto& [state, weight] : exact) {
      for (const Outcome& outcome : problem_.row(state, static_cast<std::size_t>(action))) {
        if (problem_.is_running(outcome.next)) continue;
        for (const Reading& reading : problem_.sensings[outcome.sensing]) {
          if (reading.observation == seen) ended += running * weight * outcome.probability * reading.probability;
        }
      }
    }
    return ended;
  }

  void check_belief(const Belief& belief, const Mass& exact, double running) {
    std::map<std::uint32_t, double> difference;
    double ended = 0;
    for (const auto& [state, weight] : belief.particles()) {
      if (state.ending == aos::Ending::running) {
        difference[TableModel::number_of(state)] += weight;
      } else {
        ended += weight;
      }
    }
    for (const auto& [state, weight] : exact) difference[state] -= running * weight;
    double distance = std::abs(ended - (1 - running));
    for (const auto& entry : difference) distance += std::abs(entry.second);
    ++claims_;
    const double claimed = belief.error_bound();
    if (distance / 2 <= claimed + 1e-9) return;
    fail("belief", "total variation within " + number(claimed), distance / 2, distance / 2);
  }

  void check_exact_values(const Belief& belief, const Mass& exact, double running) {
    aos::StateSpace<TableModel> space;
    if (!space.reach(belief)) return;
    const aos::ObservableValues observable{space.rows(), space.numbering(), problem_.horizon};
    for (const int decisions : {1, 3, problem_.horizon}) {
      aos::ExactEvaluation evaluation{space.rows(), observable, {.beliefs = 3000, .work = 100'000'000}};
      try {
        aos::List<double> values;
        for (const auto& of_action : evaluation.action_values(space.exact_weights_of(belief), decisions)) values.push_back(of_action.value);
        check_action_values("exact value of action ", values, exact, running, decisions);
      } catch (const aos::NotEnumerable&) {
        return;
      }
    }
  }

  void check_action_values(const std::string& claim, const aos::List<double>& values, const Mass& exact,
                           double running, int decisions) {
    Truth& truth = truth_of(decisions);
    for_some_actions(values.size(), [&](std::size_t action) {
      const Bracket bracket = bracket_of(action, truth, exact, decisions, 1e-7);
      check_within(claim + std::to_string(action), values[action], {running * bracket.lower, running * bracket.upper},
                   1e-8 * (largest_ + std::abs(bracket.upper)));
    });
  }

  void check_planner(aos::PlannerKind kind, Planner& planner, const Belief& belief, const Mass& exact, double running) {
    aos::Sampler random{options_.seed + 17};
    planner.search(kind, belief, {.simulations = options_.simulations}, problem_.horizon, random);
    who_ = std::string{aos::planner_names[static_cast<std::size_t>(kind)]} + " (" + planner.name() + ")";
    planners_[planner.name()] += 1;
    const std::string& why = planner.why();
    static const std::regex worth{"(?:with ([0-9]+) decisions to go|without a horizon) the belief is worth between "
                                  "(-?[0-9.e+-]+) and (-?[0-9.e+-]+)"};
    static const std::regex listed{"([0-9]+) states can be listed"};
    std::smatch found;
    if (std::regex_search(why, found, worth)) {
      const int decisions = found[1].matched ? std::stoi(found[1]) : 0;
      check_bounds(std::stod(found[2]), std::stod(found[3]), exact, running, decisions, why);
      // What a simple policy returned in played missions is an estimate.
      const bool is_proven = why.find("a simple policy decides") == std::string::npos;
      if (planner.name() == std::string{"sarsop"} && is_proven) {
        check_lower_values(planner.estimates(belief), exact, running, decisions);
      }
    }
    if (std::regex_search(why, found, listed)) check_states(std::stoul(found[1]), exact, why);
    if (planner.name() == std::string{"exact"}) {
      aos::List<double> values;
      for (const aos::ActionEstimate& estimate : planner.estimates(belief)) values.push_back(estimate.q);
      check_action_values("value of action ", values, exact, running, problem_.horizon);
    }
    check_proven(planner, belief, exact, running);
    who_.clear();
  }

  // What decisions say is proven of actions, for as many decisions as the horizon has.
  void check_proven(const Planner& planner, const Belief& belief, const Mass& exact, double running) {
    const aos::List<aos::ActionEstimate> estimates = planner.estimates(belief);
    const auto values = planner.values(belief, estimates, planner.choice(belief, estimates, {}));
    Truth& truth = truth_of(problem_.horizon);
    for_some_actions(values.size(), [&](std::size_t action) {
      const auto& [at_least, at_most] = std::pair{values[action].at_least, values[action].at_most};
      if (!std::isfinite(at_least) && !std::isfinite(at_most)) return;
      const Bracket bracket = bracket_of(action, truth, exact, problem_.horizon, 1e-6);
      const double rounding = 1e-8 * (largest_ + std::abs(bracket.upper));
      ++claims_;
      if (at_least <= running * bracket.upper + rounding && at_most >= running * bracket.lower - rounding &&
          at_least <= at_most) return;
      fail("proven of action " + std::to_string(action), number(at_least) + " to " + number(at_most),
           running * bracket.lower, running * bracket.upper);
    });
  }

  // The truth with so many decisions to go; 0 counts none.
  Truth& truth_of(int decisions) { return truths_.try_emplace(decisions, flat_, decisions).first->second; }

  // Of a belief of which `running` has not ended; the rest is worth nothing.
  void check_bounds(double lower, double upper, const Mass& exact, double running, int decisions,
                    const std::string& why) {
    if (decisions == 0 && problem_.discount >= 1) return fail("bounds without an end", why, -INFINITY, INFINITY);
    Truth& truth = truth_of(decisions);
    within_allowance([&](double seconds) { truth.narrow(exact, decisions, 1e-7 * largest_, seconds / 2); });
    Bracket bracket = truth.value(exact, decisions);
    bracket = {running * bracket.lower, running * bracket.upper};
    widest_ = std::max(widest_, bracket.gap() / largest_);
    const double rounding = 1e-8 * (largest_ + std::abs(bracket.upper));
    ++claims_;
    if (lower > upper) {
      fail(lower > upper + rounding ? "bounds cross" : "bounds cross by rounding", why, bracket.lower, bracket.upper);
    } else if (lower > bracket.upper + rounding || upper < bracket.lower - rounding) {
      // Four digits that are rounded to the nearest number are another mistake than a wrong bound.
      const double digits = 6e-4 * std::max(std::abs(lower), std::abs(upper));
      const bool is_printing = lower <= bracket.upper + digits && upper >= bracket.lower - digits;
      fail(is_printing ? "bounds as printed" : "bounds", why, bracket.lower, bracket.upper);
    }
  }

  // Of point-based search: what each action is worth at least.
  void check_lower_values(const aos::List<aos::ActionEstimate>& estimates, const Mass& exact, double running,
                          int decisions) {
    Truth& truth = truth_of(decisions);
    for_some_actions(estimates.size(), [&](std::size_t action) {
      if (estimates[action].n == 0) return;
      const double upper = running * bracket_of(action, truth, exact, decisions, 1e-6).upper;
      ++claims_;
      if (estimates[action].q > upper + 1e-8 * (largest_ + std::abs(upper))) {
        fail("lower value of action " + std::to_string(action), number(estimates[action].q), -INFINITY, upper);
      }
    });
  }

  void for_some_actions(std::size_t count, const std::function<void(std::size_t action)>& look) {
    for (std::size_t i = 0; i < std::min(count, max_actions); ++i) look(count <= max_actions ? i : choosing_.bits() % count);
  }

  // What an action is worth, if time allows with a gap of so small a part of the largest reward.
  Bracket bracket_of(std::size_t action, Truth& truth, const Mass& exact, int decisions, double gap) {
    within_allowance([&](double seconds) { truth.narrow_action(exact, action, decisions, gap * largest_, seconds / 4); });
    return truth.action_value(exact, action, decisions);
  }

  // What narrows a bracket takes a part of the time that is left for the problem; brackets hold at any time.
  template <class Narrow>
  void within_allowance(Narrow&& narrow) {
    const double before = processor_seconds();
    if (allowance_ > 0) narrow(allowance_);
    allowance_ -= processor_seconds() - before;
  }

  void check_states(std::size_t claimed, const Mass& exact, const std::string& why) {
    const std::size_t classes = told_apart(plain_, exact);
    ++claims_;
    if (claimed >= classes) return;
    fail("states that matter", why, static_cast<double>(classes), static_cast<double>(flat_.states()));
  }

  // Point-based search on the tables themselves, without the engine's way to them.
  struct OnTables {
    explicit OnTables(const aos::point_based::FlatModel& given) : model(given) {}
    aos::point_based::FlatModel model;
    aos::point_based::OnlineSarsop search{model};
    listed::ListedBeliefs beliefs{model};
  };

  void start_tables(const Mass& start) {
    aos::point_based::FlatModel model;
    model.states = flat_.states();
    model.actions = flat_.actions();
    model.discount = flat_.discount();
    model.outcomes.first.push_back(0);
    model.likelihoods.first.push_back(0);
    std::map<int, std::uint32_t> observations;
    for (std::size_t state = 0; state < flat_.states(); ++state) {
      for (std::size_t action = 0; action < flat_.actions(); ++action) {
        if (!problem_.is_running(state)) {
          model.rewards.push_back(0);
          model.outcomes.first.push_back(model.outcomes.elements.size());
          continue;
        }
        model.rewards.push_back(flat_.reward(state, action));
        std::map<std::uint32_t, std::map<std::uint32_t, double>> by_next;
        for (const Branch& branch : plain_.branches(state, action)) {
          const auto number = static_cast<std::uint32_t>(observations.size());
          const auto seen = observations.try_emplace(branch.observation, number).first->second;
          by_next[branch.next][seen] += branch.probability;
        }
        for (const auto& [next, seen] : by_next) {
          double total = 0;
          for (const auto& entry : seen) total += entry.second;
          const auto sensing = static_cast<std::uint32_t>(model.likelihoods.first.size() - 1);
          for (const auto& [observation, probability] : seen) {
            model.likelihoods.elements.push_back({observation, probability / total});
          }
          model.likelihoods.first.push_back(model.likelihoods.elements.size());
          model.outcomes.elements.push_back({next, sensing, total});
        }
        model.outcomes.first.push_back(model.outcomes.elements.size());
      }
    }
    model.observations = observations.size();
    model.starts.push_back({1, {start.begin(), start.end()}});
    constexpr double hardly_any = 0.9999;
    const double own = model.discount;
    for (const auto& [decisions, discount] : {std::pair{0, own}, {problem_.horizon, own}, {0, hardly_any}}) {
      if (decisions == 0 && discount >= 1) continue;
      model.horizon = static_cast<std::size_t>(decisions);
      model.discount = discount;
      try {
        tables_.push_back(std::make_unique<OnTables>(model));
      } catch (const std::length_error&) {
        continue;
      }
    }
    // An action loses a million times what can be earned, in one state.
    model.horizon = static_cast<std::size_t>(problem_.horizon);
    model.discount = own;
    model.rewards[choosing_.bits() % model.rewards.size()] = -1e6 * largest_;
    tables_.push_back(std::make_unique<OnTables>(model));
  }

  void check_tables(const Mass& exact) {
    for (const auto& on_tables : tables_) {
      auto& [model, search, beliefs] = *on_tables;
      const auto decisions = static_cast<int>(model.horizon);
      who_ = "point-based search on the tables, discount " + number(model.discount);
      if (!search.move_to({exact.begin(), exact.end()})) continue;
      listed::Belief belief{exact.begin(), exact.end()};
      listed::Real total = 0;
      for (const auto& entry : belief) total += entry.second;
      for (auto& entry : belief) entry.second /= total;
      const aos::List<listed::Interval> truth = beliefs.action_values(belief, 200);
      for (const std::uint64_t work : {std::uint64_t{1}, 1000 * options_.simulations}) {
        search.improve(work, [] { return false; });
        check_to_the_last_digit(search, truth, beliefs.tolerance());
      }
      if (model.discount != flat_.discount() || on_tables == tables_.back()) continue;
      const auto [lower, upper] = search.bounds();
      check_bounds(lower, upper, exact, 1, decisions, "between " + number(lower) + " and " + number(upper));
    }
    who_.clear();
  }

  // Bounds in floating point hold in floating point: rounding is part of them.
  void check_to_the_last_digit(aos::point_based::OnlineSarsop& search, const aos::List<listed::Interval>& truth,
                               listed::Real tolerance) {
    const aos::List<aos::point_based::ActionBounds> bounds = search.action_bounds();
    listed::Interval best = truth.front();
    for (std::size_t action = 0; action < bounds.size(); ++action) {
      best.lower = std::max(best.lower, truth[action].lower);
      best.upper = std::max(best.upper, truth[action].upper);
      const std::string claim = "bounds of action " + std::to_string(action);
      check_enclosed(claim, {bounds[action].lower, bounds[action].upper}, truth[action], tolerance);
    }
    const auto [lower, upper] = search.bounds();
    check_enclosed("bounds", {lower, upper}, best, tolerance);
  }
  void check_enclosed(const std::string& claim, Bracket said, const listed::Interval& truth, listed::Real rounding) {
    ++claims_;
    if (said.lower <= said.upper && said.lower <= truth.upper + rounding && said.upper >= truth.lower - rounding) return;
    fail(claim, number(said.lower) + " to " + number(said.upper), static_cast<double>(truth.lower),
         static_cast<double>(truth.upper));
  }

  // Findings ------------------------------------------------------------

  void check(const std::string& claim, double claimed, double truth, double within) {
    ++claims_;
    if (!(std::abs(claimed - truth) <= within)) fail(claim, number(claimed), truth, truth);
  }
  void check_within(const std::string& claim, double claimed, Bracket truth, double rounding) {
    ++claims_;
    if (claimed < truth.lower - rounding || claimed > truth.upper + rounding) {
      fail(claim, number(claimed), truth.lower, truth.upper);
    }
  }

  void fail(const std::string& claim, const std::string& said, double lower, double upper) {
    findings_.push_back({claim, who_, where_, said, lower, upper});
  }
  static std::string number(double value) { return aos::number_text(value); }

  std::string text() {
    aos::JsonWriter json;
    json.begin_object().member("problem", problem_.name).member("states", problem_.states()).member("claims", claims_);
    json.member("widest_bracket", widest_).key("planners").begin_object();
    for (const auto& [name, count] : planners_) json.member(name, count);
    json.end_object().key("false").begin_array();
    for (const Finding& each : findings_) {
      json.begin_object().member("claim", each.claim).member("who", each.who).member("where", each.where);
      json.member("said", each.said).member("lower", each.lower).member("upper", each.upper).end_object();
    }
    json.end_array().end_object();
    return json.text();
  }

  static constexpr std::size_t max_actions = 6;  // that are looked at where there are many

  const Problem& problem_;
  ClaimOptions options_;
  Flat flat_;
  Flat plain_;  // by single observations
  aos::Sampler random_;
  aos::Sampler choosing_{1};  // what is looked at where not all can be
  double largest_ = 0;
  double allowance_ = options_.truth_seconds;
  std::map<int, Truth> truths_;  // by decisions; 0 counts none
  aos::List<std::unique_ptr<OnTables>> tables_;
  int claims_ = 0;
  double widest_ = 0;
  std::map<std::string, int> planners_;
  std::string where_;
  std::string who_;
  struct Finding {
    std::string claim, who, where, said;
    double lower, upper;
  };
  aos::List<Finding> findings_;
};

}
