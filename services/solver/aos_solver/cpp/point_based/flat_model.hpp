// A POMDP as numbers: what the point-based solver works on.
//
// A sensing is a distribution of observations; most outcomes share few of them.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

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

// The robot is told at the start which of these beliefs it is in.
struct Start {
  double weight;
  std::vector<std::pair<std::uint32_t, double>> belief;
};

// The elements of a row in a list of rows.
template <class Element>
struct Rows {
  std::vector<std::uint64_t> first;
  std::vector<Element> elements;

  const Element* begin(std::size_t row) const { return elements.data() + first[row]; }
  const Element* end(std::size_t row) const { return begin(row + 1); }
  std::span<const Element> operator[](std::size_t row) const { return {begin(row), end(row)}; }
};

struct FlatModel {
  std::size_t states = 0;
  std::size_t actions = 0;
  std::size_t observations = 0;
  double discount = 0;
  std::size_t horizon = 0;  // so many decisions are rewarded; 0: without end, with a discount below 1
  std::vector<double> rewards;
  Rows<Outcome> outcomes;  // of (state, action)
  Rows<Likelihood> likelihoods;  // of a sensing
  std::vector<Start> starts;

  std::size_t row(std::size_t state, std::size_t action) const { return state * actions + action; }
  // Of all actions in a state.
  std::span<const Outcome> outcomes_of(std::size_t state) const {
    return {outcomes.begin(row(state, 0)), outcomes.end(row(state, actions - 1))};
  }
  // What a row's next states are worth on average, by their values.
  double later_value(std::size_t row, const std::vector<double>& values) const {
    double sum = 0;
    for (const Outcome& outcome : outcomes[row]) sum += outcome.probability * values[outcome.next];
    return sum;
  }
};

}  // namespace aos::point_based
