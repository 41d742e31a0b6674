// The nodes of a belief graph: the beliefs that were reached, their actions, and the successors of these.
#pragma once

#include "point_based/bounds.hpp"

namespace aos::point_based {

// A belief after an observation. The weights after it are `probability` times the node's belief, and a rest.
struct Successor {
  double probability;
  std::uint32_t observation_branch;
  std::uint32_t node;
};

// An action at a belief. Its successors are found only when a trial needs them.
struct Branch {
  std::uint32_t action;
  double reward;
  double upper;
  double lower = -std::numeric_limits<double>::infinity();
  double rest = 0;        // the probability that no successor holds
  double rest_upper = 0;  // an upper bound of what the rest adds to the value
  bool is_open = false;
  List<Successor> successors{};
};

struct Node {
  Belief belief;
  std::uint32_t region;
  std::uint32_t left;                // how many decisions are left; 0 without a horizon
  std::uint32_t vector = 0;          // the best alpha vector
  std::uint32_t seen_vectors = 0;    // how many alpha vectors `lower` accounts for
  std::uint32_t seen_changes = 0;    // how many changes of the upper bound `upper` accounts for
  std::uint32_t point = nowhere;     // the number of its point in the upper bound
  double corner = 0;                 // the upper bound interpolated from single states
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool is_expanded = false;
  List<Branch> branches;  // actions that may still be the best

  // The branch of an action; null if it was dropped.
  Branch* branch_of(std::uint32_t action) {
    const auto found = std::ranges::find(branches, action, &Branch::action);
    return found != branches.end() ? &*found : nullptr;
  }
};

}
