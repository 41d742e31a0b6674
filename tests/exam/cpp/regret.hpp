// What a planner loses in missions against the optimum, and beside it what exact look-ahead loses that plans for a
// whole horizon anew at every step.
//
// The return of a mission is estimated without most of its luck: with any function V of beliefs,
//   V(b0) + sum of discount^t (r(b_t, a_t) + discount * E V(b_t+1) - V(b_t))
// has the expectation of the return, and where V is nearly the optimum its spread is nearly that of the regret. Here V
// is the lower bound of the truth. All planners meet the same worlds: what is drawn depends on the seed, the mission
// and the step only.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/planners.hpp"
#include "aos/text/json.hpp"
#include "flat.hpp"
#include "problem.hpp"
#include "table_model.hpp"
#include "truth.hpp"

namespace exam {

struct RegretOptions {
  std::uint64_t seed = 1;
  // "look-ahead" is exact look-ahead. In a build for ablations, "auto/prior+turns" is `auto` without these mechanisms.
  aos::List<std::string> planners;
  double seconds = 0.1;               // of processor time for a decision; 0: without this limit
  std::uint64_t simulations = 0;      // 0: without this limit
  int missions = 4;
  int steps = 0;  // of a mission; 0: the horizon
  double truth_seconds = 5;
  bool judges_decisions = true;  // `by_decisions`, which takes a tenth of a second of each
};

class Regret {
 public:
  using Belief = aos::Belief<TableModel>;
  using Planner = aos::Planners<TableModel>;

  Regret(const Problem& problem, RegretOptions options)
      : problem_(problem), options_(std::move(options)), flat_(problem, true),
        steps_(options_.steps > 0 ? options_.steps : problem.horizon),
        truth_(flat_, std::max(steps_, problem.horizon)) {
    TableModel::take(problem);
    aos::PlanningClock::counts_processor_time = true;
  }

  std::string report() {
    aos::JsonWriter json;
    json.begin_object().member("problem", problem_.name).member("states", problem_.states());
    json.member("actions", problem_.actions).member("steps", steps_);
    const auto [start, running] = flat_.start();
    const double random = expected(start, random_values(flat_, steps_));
    const double scale = std::max(flat_.largest_reward(), 1e-9);
    truth_.narrow(start, steps_, 1e-4 * scale, 0.2 * options_.truth_seconds);
    double range = truth_.value(start, steps_).lower - random;
    if (range > 0) truth_.narrow(start, steps_, 2e-3 * range, 0.8 * options_.truth_seconds);
    const Bracket optimum = truth_.value(start, steps_);
    range = optimum.middle() - random;
    json.member("optimum", optimum.middle()).member("gap", optimum.gap()).member("random", random);
    const char* obstacle = "";
    if (!(range > 1e-3 * scale)) {
      obstacle = "hardly anything is to be gained";
    } else if (optimum.gap() > 0.01 * range) {
      obstacle = "the optimum is not known well enough";
    }
    json.member("obstacle", obstacle);
    if (*obstacle == 0) {
      json.key("planners").begin_array();
      for (const std::string& name : options_.planners) play_all(json, name, start, optimum.middle(), range);
      json.end_array();
    }
    return json.end_object().text();
  }

 private:
  struct Decision {
    int action;
    std::string name;
    std::string why;
    aos::ActionEstimate told{};  // of the action, as decisions tell it; look-ahead tells nothing
  };
  struct Played {
    double value = 0;         // without most of its luck
    double discounted = 0;    // what the mission returned
    double by_decisions = 0;  // what its decisions lose, each with a whole horizon to go
    std::string actions;
  };

  void play_all(aos::JsonWriter& json, const std::string& name, const Mass& start, double optimum, double range) {
    aos::List<double> regrets;
    aos::List<double> returns;
    double by_decisions = 0;
    Played worst;
    double highest = -INFINITY;
    aos::List<double> times;  // of decisions, in seconds of processor time
    Decision first{};
    std::optional<Planner> planner;
    const std::string own_name = with_switches(name);
    if (name != "look-ahead") planner.emplace();
    std::string fault;
    for (int mission = 0; mission < options_.missions && fault.empty(); ++mission) {
      if (planner) planner->start_over();
      const auto decide = [&](const Mass& exact, const Belief& belief, int step) {
        const double before = processor_seconds();
        const Decision decision = planner ? searched(*planner, own_name, belief, mission, step)
                                          : Decision{looked_ahead(exact), "look-ahead", "", {}};
        times.push_back(processor_seconds() - before);
        if (times.size() == 1) first = decision;
        return decision.action;
      };
      const Played played = play(start, mission, planner ? &*planner : nullptr, decide, fault);
      regrets.push_back((optimum - played.value) / range);
      returns.push_back(played.discounted);
      by_decisions += played.by_decisions / range / options_.missions;
      if (regrets.back() > highest) {
        highest = regrets.back();
        worst = played;
      }
    }
    const Mean regret = mean_of(regrets);
    const Mean returned = mean_of(returns);
    json.begin_object().member("planner", name).member("regret", regret.mean);
    json.member("by_decisions", by_decisions).member("standard_error", regret.error);
    json.member("returned", returned.mean).member("returned_error", returned.error);
    json.member("told", first.told.q).member("told_error", first.told.standard_error);
    json.member("at_least", first.told.at_least).member("at_most", first.told.at_most);
    json.member("used", first.name).member("why", first.why);
    json.key("times").begin_array();
    for (const double time : times) json.value(time);
    json.end_array();
    json.member("worst_actions", worst.actions).member("fault", fault).end_object();
  }

  // The planner's own name, with what is named after it switched off.
  static std::string with_switches(const std::string& name) {
#ifdef AOS_ABLATION
    const std::size_t end = std::min(name.find('/'), name.size());
    aos::switches::leave_out(end < name.size() ? name.substr(end + 1) : "");
    return name.substr(0, end);
#else
    return name;
#endif
  }

  struct Mean {
    double mean = 0;
    double error = 0;  // its standard error
  };
  static Mean mean_of(const aos::List<double>& numbers) {
    const auto count = static_cast<double>(numbers.size());
    Mean result;
    double squares = 0;
    for (const double number : numbers) result.mean += number / count;
    for (const double number : numbers) squares += (number - result.mean) * (number - result.mean);
    if (count > 1) result.error = std::sqrt(squares / (count - 1) / count);
    return result;
  }

  template <class Decide>
  Played play(const Mass& start, int mission, Planner* planner, Decide&& decide, std::string& fault) {
    aos::Sampler world{mixed(options_.seed, static_cast<std::uint64_t>(mission), 0)};
    aos::Sampler updates{mixed(options_.seed, static_cast<std::uint64_t>(mission), 1)};
    Belief belief = Belief::initial(updates);
    Mass exact = start;
    std::uint32_t hidden = drawn(exact, world.uniform());
    double value = truth_.value(exact, steps_).lower;
    Played played{value, 0, 0, ""};
    double discount = 1;
    for (int step = 0; step < steps_; ++step) {
      const int action = decide(exact, belief, step);
      played.actions += (step > 0 ? " " : "") + std::to_string(action);
      const auto a = static_cast<std::size_t>(action);
      const aos::List<Reached> all_reached = flat_.reached(exact, a);
      aos::List<double> values;
      double later = 0;
      for (const Reached& reached : all_reached) {
        values.push_back(truth_.value(reached.belief, steps_ - step - 1).lower);
        later += reached.probability * values.back();
      }
      played.value += discount * (flat_.expected_reward(exact, a) + flat_.discount() * later - value);
      if (options_.judges_decisions) played.by_decisions += discount * lost_by(exact, a);
      // One number for where the world goes, one for what is seen of it, whatever was decided.
      const double outcome_drawn = world.uniform();
      const double seen_drawn = world.uniform();
      const Outcome& outcome = drawn_from(problem_.row(hidden, a), outcome_drawn);
      const int seen = drawn_from(problem_.sensings[outcome.sensing], seen_drawn).observation;
      played.discounted += discount * outcome.reward;
      discount *= flat_.discount();
      hidden = outcome.next;
      if (!problem_.is_running(hidden)) break;
      const int observation_branch = flat_.observation_branch(a, seen);
      const auto found = std::find_if(all_reached.begin(), all_reached.end(),
                                      [&](const Reached& reached) { return reached.observation == observation_branch; });
      exact = found->belief;
      value = values[found - all_reached.begin()];
      if (planner == nullptr) continue;
      auto posterior = posterior_of(belief, action, seen, updates).first;
      if (posterior.particles().empty()) {
        fault = "the belief holds impossible what has happened";
        break;
      }
      belief = std::move(posterior);
      planner->move_to(action, seen);
    }
    return played;
  }

  Decision searched(Planner& planner, const std::string& name, const Belief& belief, int mission, int step) {
    const auto use = 2 + static_cast<std::uint64_t>(step);
    aos::Sampler random{mixed(options_.seed, static_cast<std::uint64_t>(mission), use)};
    const aos::Budget budget{.simulations = options_.simulations, .seconds = options_.seconds};
    planner.search(kind_of(name), belief, budget, problem_.horizon, random);
    const aos::List<aos::ActionEstimate> estimates = planner.estimates(belief);
    const int action = planner.choice(belief, estimates, {});
    const auto told = planner.values(belief, estimates, action)[action];
    return {action, planner.name(), planner.why(), told};
  }

  // Also of planners that cannot be asked for by name.
  static aos::PlannerKind kind_of(const std::string& name) {
    const auto* const found = std::ranges::find(aos::planner_names, name);
    if (found == std::end(aos::planner_names)) throw std::runtime_error("there is no planner " + name);
    return static_cast<aos::PlannerKind>(found - aos::planner_names);
  }

  // Against the best action, with a whole horizon to go.
  double lost_by(const Mass& exact, std::size_t action) {
    const double scale = std::max(flat_.largest_reward(), 1e-9);
    truth_.narrow(exact, problem_.horizon, 1e-5 * scale, 0.05);
    truth_.narrow_action(exact, action, problem_.horizon, 1e-5 * scale, 0.05);
    const double best = truth_.value(exact, problem_.horizon).lower;
    return std::max(best - truth_.action_value(exact, action, problem_.horizon).lower, 0.0);
  }

  // The best action with a whole horizon to go. Of equal ones, the one that is better with fewer decisions to go, so
  // that nothing is put off for ever where nothing is lost by waiting.
  int looked_ahead(const Mass& exact) {
    const double scale = std::max(flat_.largest_reward(), 1e-9);
    truth_.narrow(exact, problem_.horizon, 1e-6 * scale, 0.1);
    aos::List<std::size_t> equal(flat_.actions());
    std::iota(equal.begin(), equal.end(), std::size_t{0});
    for (int left = problem_.horizon; left > 0 && equal.size() > 1; --left) {
      aos::List<double> values;
      for (const std::size_t action : equal) values.push_back(truth_.action_value(exact, action, left).lower);
      const double best = *std::max_element(values.begin(), values.end());
      aos::List<std::size_t> kept;
      for (std::size_t i = 0; i < equal.size(); ++i) {
        if (values[i] >= best - 1e-9 * scale) kept.push_back(equal[i]);
      }
      equal.swap(kept);
    }
    return static_cast<int>(equal.front());
  }

  static std::uint64_t mixed(std::uint64_t seed, std::uint64_t mission, std::uint64_t use) {
    // The seed by itself first: neighbouring seeds would else have worlds in common.
    return aos::mixed(aos::mixed(aos::mixed(0, seed), mission), use);
  }
  static std::uint32_t drawn(const Mass& belief, double uniform) {
    for (const auto& [state, weight] : belief) {
      if ((uniform -= weight) < 0) return state;
    }
    return belief.back().first;
  }
  template <class Weighted>
  static const Weighted& drawn_from(const aos::List<Weighted>& all, double uniform) {
    for (const Weighted& one : all) {
      if ((uniform -= one.probability) < 0) return one;
    }
    const auto last = std::find_if(all.rbegin(), all.rend(), [](const Weighted& one) { return one.probability > 0; });
    return *last;
  }

  const Problem& problem_;
  RegretOptions options_;
  Flat flat_;
  int steps_;
  Truth truth_;
};

}
