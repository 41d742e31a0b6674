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
inline std::string values_of(const Problem& problem, int decisions, double seconds) {
  const Flat flat{problem, true};
  Truth truth{flat, decisions};
  const auto [start, running] = flat.start();
  aos::JsonWriter json;
  json.begin_object().member("problem", problem.name).key("values").begin_array();
  for (std::size_t action = 0; action < problem.actions; ++action) {
    truth.narrow_action(start, action, decisions, 1e-9 * flat.largest_reward(), seconds);
    const Bracket value = truth.action_value(start, action, decisions);
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

inline std::string report_of(const std::string& what, const Problem& problem, const Options& options) {
  if (what == "values") {
    const auto decisions = static_cast<int>(number_of(options, "decisions", problem.horizon));
    return values_of(problem, decisions, number_of(options, "truth", 1));
  }
  if (what == "intervals") return intervals_of(problem, chosen<IntervalOptions>(options, 5000, 0.5, 3));
  if (what == "bounds") return Claims{problem, chosen<ClaimOptions>(options, 2000, 1, 4)}.report();
  auto regret = chosen<RegretOptions>(options, 0, 5, 0);
  regret.seconds = number_of(options, "seconds", 0);
  regret.missions = static_cast<int>(number_of(options, "missions", 4));
  regret.judges_decisions = number_of(options, "judged", 1) != 0;
  const std::string names = options.at("planners");
  for (std::size_t first = 0; first <= names.size();) {
    const std::size_t last = std::min(names.find(',', first), names.size());
    regret.planners.push_back(names.substr(first, last - first));
    first = last + 1;
  }
  return Regret{problem, regret}.report();
}

inline std::string report_of_fault(const Problem& problem, const std::string& fault) {
  aos::JsonWriter json;
  return json.begin_object().member("problem", problem.name).member("fault", fault).end_object().text();
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
    while (const auto problem = read_problem(std::cin)) {
      std::string report;
      try {
        report = report_of(what, *problem, options);
      } catch (const aos::ModelFault& fault) {
        report = report_of_fault(*problem, fault.text);
      } catch (const aos::NotEnumerable& obstacle) {
        report = report_of_fault(*problem, obstacle.reason);
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
