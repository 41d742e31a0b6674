// The exam of the engine's planners and bounds: problems come on standard input, and a report of each goes out as a
// line of JSON. See tests/exam/__main__.py for how it is called.
#pragma once

#include <iostream>

#include "aos/model/support.hpp"
#include "claims.hpp"
#include "intervals.hpp"
#include "regret.hpp"
#include "truth.hpp"

namespace exam {

using Options = std::map<std::string, std::string>;

inline double number_of(const Options& options, const std::string& name, double otherwise) {
  const auto found = options.find(name);
  return found != options.end() ? std::atof(found->second.c_str()) : otherwise;
}

// The true values of the actions at the start, as brackets: with so many decisions to go, or without an end (0).
inline std::string values_of(const exam::Problem& problem, int decisions, double seconds) {
  const exam::Flat flat{problem, true};
  exam::Truth truth{flat, decisions};
  const auto [start, running] = flat.start();
  aos::JsonWriter json;
  json.begin_object().member("problem", problem.name).key("values").begin_array();
  for (std::size_t action = 0; action < problem.actions; ++action) {
    truth.narrow_action(start, action, decisions, 1e-9 * flat.largest_reward(), seconds);
    const exam::Bracket value = truth.action_value(start, action, decisions);
    json.begin_array().value(running * value.lower).value(running * value.upper).end_array();
  }
  return json.end_array().end_object().text();
}

// What the command line says of an exam, or else these numbers.
template <class Chosen>
Chosen chosen(const Options& options, double simulations, double truth_seconds, double steps) {
  Chosen made;
  made.seed = static_cast<std::uint64_t>(number_of(options, "seed", 1));
  made.simulations = static_cast<std::uint64_t>(number_of(options, "simulations", simulations));
  made.truth_seconds = number_of(options, "truth", truth_seconds);
  made.steps = static_cast<int>(number_of(options, "steps", steps));
  return made;
}

inline std::string report_of(const std::string& what, const exam::Problem& problem, const Options& options) {
  if (what == "values") {
    const auto decisions = static_cast<int>(number_of(options, "decisions", problem.horizon));
    return values_of(problem, decisions, number_of(options, "truth", 1));
  }
  if (what == "intervals") {
    return exam::intervals_of(problem, chosen<exam::IntervalOptions>(options, 5000, 0.5, 3));
  }
  if (what == "bounds") {
    return exam::Claims{problem, chosen<exam::ClaimOptions>(options, 2000, 1, 4)}.report();
  }
  exam::RegretOptions regret;
  regret.seed = static_cast<std::uint64_t>(number_of(options, "seed", 1));
  regret.seconds = number_of(options, "seconds", 0);
  regret.simulations = static_cast<std::uint64_t>(number_of(options, "simulations", 0));
  regret.missions = static_cast<int>(number_of(options, "missions", 4));
  regret.steps = static_cast<int>(number_of(options, "steps", 0));
  regret.truth_seconds = number_of(options, "truth", 5);
  regret.judges_decisions = number_of(options, "judged", 1) != 0;
  const std::string names = options.at("planners");
  for (std::size_t first = 0; first <= names.size();) {
    const std::size_t last = std::min(names.find(',', first), names.size());
    regret.planners.push_back(names.substr(first, last - first));
    first = last + 1;
  }
  return exam::Regret{problem, regret}.report();
}

// Takes the arguments that the usage below tells of. Returns the exit status.
inline int answer_problems(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  Options options;
  for (int i = 2; i + 1 < argc; i += 2) options[argv[i]] = argv[i + 1];
  if (what != "bounds" && what != "regret" && what != "values" && what != "intervals") {
    std::fprintf(stderr, "usage: %s bounds|regret|values|intervals [NAME VALUE]... < PROBLEMS\n", argv[0]);
    return 2;
  }
  try {
    while (const auto problem = exam::read_problem(std::cin)) {
      std::string report;
      try {
        report = report_of(what, *problem, options);
      } catch (const aos::ModelFault& fault) {
        aos::JsonWriter json;
        report = json.begin_object().member("problem", problem->name).member("fault", fault.text).end_object().text();
      } catch (const aos::NotEnumerable& obstacle) {
        aos::JsonWriter json;
        json.begin_object().member("problem", problem->name).member("fault", obstacle.reason).end_object();
        report = json.text();
      }
      std::puts(report.c_str());
      std::fflush(stdout);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "exam: %s\n", error.what());
    return 1;
  }
  return 0;
}

}
