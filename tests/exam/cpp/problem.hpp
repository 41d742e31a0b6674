// A POMDP as the exam's generators write it: every state that can be reached, and for each of them and each action what
// can come of it. The engine's model (table_model.hpp) and the truth (truth.hpp) have these tables in common, and
// nothing else.
//
// The text is a sequence of words, in this order:
//   problem NAME
//   discount D  horizon H  actions A  variables K  states S  sensings N  starts B  irrelevant I
//   each of the I variables of which it is said that they do not matter
//   of each state its K variables and its ending (0 running, 1 goal, 2 failure, 3 over)
//   of each sensing the number of its readings, and of each its observation and its probability
//   of each start its state and its probability
//   of each running state and each action the number of its outcomes, and of each its probability, its next state, its
//   sensing and its reward
//   end
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <stdexcept>
#include <string>

#include "aos/base/list.hpp"

namespace exam {

struct Reading {
  int observation;
  double probability;
};

struct Outcome {
  double probability;
  std::uint32_t next;
  std::uint32_t sensing;
  double reward;
};

struct Start {
  std::uint32_t state;
  double probability;
};

// Whether each step draws a number, so that states cannot be listed, and whether directed draws are refused as well.
enum class Noise { none, drawn, refused };

struct Problem {
  std::string name;
  double discount = 0;
  int horizon = 0;
  std::size_t actions = 0;
  std::size_t variables = 0;
  aos::List<std::size_t> irrelevant;  // variables that do not matter, and of which the engine is told so
  aos::List<int> values;   // of the variables, state by state
  aos::List<int> endings;  // of the states; 0 runs
  aos::List<aos::List<Reading>> sensings;
  aos::List<Start> starts;
  aos::List<aos::List<Outcome>> rows;  // by state and action; none of a state that has ended

  // What tests of the headers set, and no text says.
  aos::List<int> conditions;  // how many conditions of the goal hold in each state; none where nobody counts them
  Noise noise = Noise::none;

  std::size_t states() const { return endings.size(); }
  bool is_running(std::size_t state) const { return endings[state] == 0; }
  const aos::List<Outcome>& row(std::size_t state, std::size_t action) const {
    return rows[state * actions + action];
  }
};

namespace detail {

class Words {
 public:
  explicit Words(std::istream& in) : in_(in) {}

  void expect(const char* word) {
    std::string read;
    if (!(in_ >> read) || read != word) throw std::runtime_error("a problem has '" + read + "' in place of " + word);
  }
  template <class Value>
  Value next() {
    Value value{};
    if (!(in_ >> value)) throw std::runtime_error("a problem ends too early, or holds what is no number");
    return value;
  }
  template <class Value>
  Value named(const char* word) {
    expect(word);
    return next<Value>();
  }

 private:
  std::istream& in_;
};

}  // namespace detail

// The next problem; nothing at the end of the text.
inline std::optional<Problem> read_problem(std::istream& in) {
  if ((in >> std::ws).eof()) return std::nullopt;
  detail::Words words{in};
  Problem problem;
  problem.name = words.named<std::string>("problem");
  problem.discount = words.named<double>("discount");
  problem.horizon = words.named<int>("horizon");
  problem.actions = words.named<std::size_t>("actions");
  problem.variables = words.named<std::size_t>("variables");
  const auto states = words.named<std::size_t>("states");
  problem.sensings.resize(words.named<std::size_t>("sensings"));
  problem.starts.resize(words.named<std::size_t>("starts"));
  problem.irrelevant.resize(words.named<std::size_t>("irrelevant"));
  for (std::size_t& variable : problem.irrelevant) variable = words.next<std::size_t>();
  for (std::size_t state = 0; state < states; ++state) {
    for (std::size_t i = 0; i < problem.variables; ++i) problem.values.push_back(words.next<int>());
    problem.endings.push_back(words.next<int>());
  }
  for (auto& sensing : problem.sensings) {
    sensing.resize(words.next<std::size_t>());
    for (Reading& reading : sensing) {
      reading.observation = words.next<int>();
      reading.probability = words.next<double>();
    }
  }
  for (Start& start : problem.starts) {
    start.state = words.next<std::uint32_t>();
    start.probability = words.next<double>();
  }
  problem.rows.resize(states * problem.actions);
  for (std::size_t state = 0; state < states; ++state) {
    if (!problem.is_running(state)) continue;
    for (std::size_t action = 0; action < problem.actions; ++action) {
      auto& row = problem.rows[state * problem.actions + action];
      row.resize(words.next<std::size_t>());
      for (Outcome& outcome : row) {
        outcome.probability = words.next<double>();
        outcome.next = words.next<std::uint32_t>();
        outcome.sensing = words.next<std::uint32_t>();
        outcome.reward = words.next<double>();
      }
    }
  }
  words.expect("end");
  return problem;
}

}  // namespace exam
