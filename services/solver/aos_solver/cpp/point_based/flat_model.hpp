// A POMDP as numbers, for the point-based solver. A sensing is a distribution of observations that many outcomes share.
#pragma once

#include <cstdint>
#include <span>

#include "aos/base/list.hpp"

namespace aos::point_based {

struct Outcome {
  std::uint32_t next;
  std::uint32_t sensing;
  double probability;
};

struct Likelihood {
  std::uint32_t observation;
  double probability;
};

// A belief in which a mission may start, and its probability. The robot is told which of the starts it is in.
struct Start {
  double weight;
  List<std::pair<std::uint32_t, double>> belief;
};

// A list of rows, each with its own number of elements.
template <class Element>
struct Rows {
  List<std::uint64_t> first;
  List<Element> elements;

  const Element* begin(std::size_t row) const { return elements.data() + first[row]; }
  const Element* end(std::size_t row) const { return begin(row + 1); }
  std::span<const Element> operator[](std::size_t row) const { return {begin(row), end(row)}; }
};

// Tells which number stands for which state: in two equal numberings, the numbers are the same.
struct Numbering {
  std::uint64_t restarts = 0;
  std::size_t states = 0;
  bool operator==(const Numbering&) const = default;
};

struct FlatModel {
  std::size_t states = 0;
  std::size_t actions = 0;
  std::size_t observations = 0;
  double discount = 0;
  std::size_t horizon = 0;  // how many decisions are rewarded; 0: no end, discount below 1
  List<double> rewards;
  Rows<Outcome> outcomes;  // by row(state, action)
  Rows<Likelihood> likelihoods;  // by sensing
  List<Start> starts;

  std::size_t row(std::size_t state, std::size_t action) const { return state * actions + action; }
  std::span<const Outcome> outcomes_of(std::size_t state) const {
    return {outcomes.begin(row(state, 0)), outcomes.end(row(state, actions - 1))};
  }
  // Those of the values by row that are of a state's actions.
  std::span<const double> of_actions(const List<double>& values, std::size_t state) const { return {&values[row(state, 0)], actions}; }

  // The expected value of a row's next state.
  double later_value(std::size_t row, const List<double>& values) const {
    double sum = 0;
    for (const Outcome& outcome : outcomes[row]) sum += outcome.probability * values[outcome.next];
    return sum;
  }
};

}
