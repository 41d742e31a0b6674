// Small worlds for the tests, as the exam's tables.
#pragma once

#include "aos/base/list.hpp"
#include "aos/belief/belief.hpp"
#include "problem.hpp"
#include "table_model.hpp"

namespace units {

using exam::Problem;
using exam::TableModel;
using Belief = aos::Belief<TableModel>;

// The belief with which a problem begins. The problem is the model from then on, as long as it lives.
template <class Model = TableModel>
aos::Belief<Model> initial_belief(const Problem& problem) {
  Model::take(problem);
  aos::Sampler random{1};
  return aos::Belief<Model>::initial(random);
}
template <class Model = TableModel>
aos::Belief<Model> initial_belief(const Problem&&) = delete;

// The same, drawn.
inline Belief drawn_belief(const Problem& problem) {
  TableModel::take(problem);
  aos::Sampler random{1};
  return Belief::drawn(random);
}

// A state with which a problem begins. The problem is the model from then on, too.
inline TableModel::State first_state(const Problem& problem) {
  TableModel::take(problem);
  aos::Sampler random{1};
  TableModel::State state{};
  TableModel::initial(state, random);
  return state;
}

// Where a row is not filled, the state stays, nothing is seen and nothing is earned.
inline Problem world(std::size_t states, std::size_t actions, double discount) {
  Problem problem;
  problem.name = "units";
  problem.discount = discount;
  problem.horizon = 10;
  problem.actions = actions;
  problem.variables = 2;
  for (std::size_t state = 0; state < states; ++state) {
    problem.values.push_back(static_cast<int>(state));
    problem.values.push_back(0);
  }
  problem.endings.assign(states, 0);
  problem.sensings = {{{-1, 1.0}}};
  problem.starts = {{0, 1.0}};
  for (std::uint32_t state = 0; state < states; ++state) {
    for (std::size_t action = 0; action < actions; ++action) problem.rows.push_back({{1.0, state, 0, 0.0}});
  }
  return problem;
}

// A problem begins in each of these states as likely.
inline void start_evenly(Problem& problem, std::uint32_t first, std::uint32_t end) {
  problem.starts.clear();
  for (std::uint32_t state = first; state < end; ++state) problem.starts.push_back({state, 1.0 / (end - first)});
}

inline aos::List<exam::Outcome>& row(Problem& problem, std::size_t state, std::size_t action) {
  return problem.rows[state * problem.actions + action];
}

// Adds what is observed where 0 is right, and where 1 is: the right one with this probability.
inline void hear(Problem& problem, double right) {
  problem.sensings.push_back({{0, right}, {1, 1 - right}});
  problem.sensings.push_back({{0, 1 - right}, {1, right}});
}

// The tiger behind one of two doors (Kaelbling, Littman and Cassandra, 1998): listen, open left, open right. It is
// heard on the left as 0.
inline Problem tiger() {
  Problem problem = world(2, 3, 0.95);
  problem.starts = {{0, 0.5}, {1, 0.5}};
  hear(problem, 0.85);
  for (std::uint32_t side = 0; side < 2; ++side) {
    row(problem, side, 0) = {{1.0, side, side + 1, -1}};
    for (std::size_t door = 0; door < 2; ++door) {
      const double reward = door == side ? -100 : 10;
      row(problem, side, door + 1) = {{0.5, 0, 0, reward}, {0.5, 1, 0, reward}};
    }
  }
  return problem;
}

// Cells in a row: action 0 leads on, action 1 back, and from the last cell action 0 earns 10 and ends the mission.
inline Problem corridor(std::uint32_t cells, double discount) {
  Problem problem = world(cells + 1, 2, discount);
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    row(problem, cell, 0) = {{1.0, cell + 1, 0, cell + 1 == cells ? 10.0 : 0.0}};
    row(problem, cell, 1) = {{1.0, cell > 0 ? cell - 1 : 0, 0, 0.0}};
  }
  problem.endings[cells] = 1;
  return problem;
}

// A corridor whose last action leads on. The `exits` actions before it end the mission and earn nothing.
inline Problem corridor_with_exits(std::uint32_t cells, std::size_t exits) {
  Problem problem = world(cells + 2, exits + 1, 1);
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    for (std::size_t exit = 0; exit < exits; ++exit) row(problem, cell, exit) = {{1.0, cells + 1, 0, 0.0}};
    row(problem, cell, exits) = {{1.0, cell + 1, 0, cell + 1 == cells ? 10.0 : 0.0}};
  }
  problem.endings[cells] = 1;
  problem.endings[cells + 1] = 1;
  return problem;
}

}
