// The nodes of a belief graph: beliefs that were met, their actions, and the beliefs behind these.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "point_based/bounds.hpp"

namespace aos::point_based {

// An observation leads to a belief that holds `probability` times the node's, and a rest.
struct Successor {
  double probability;
  std::uint32_t observation_branch;
  std::uint32_t node;
};

// An action at a belief. Where it leads is found out only when its upper bound is the highest: most never are.
struct Branch {
  std::uint32_t action;
  double reward;
  double upper;
  double lower = -std::numeric_limits<double>::infinity();
  double rest = 0;        // the probability that is in no successor
  double rest_upper = 0;  // what the rest is worth at most
  bool is_open = false;
  std::vector<Successor> successors{};
};

struct Node {
  Belief belief;
  std::uint32_t region;
  std::uint32_t left;                // decisions; 0 where there is no end
  std::uint32_t vector = 0;          // the best alpha vector
  std::uint32_t seen_vectors = 0;    // alpha vectors that the lower bound takes account of
  std::uint32_t seen_changes = 0;    // changes that the upper bound takes account of
  std::uint32_t point = nowhere;     // in the upper bound
  double corner = 0;                 // what the upper bound is interpolated to be from single states
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool is_expanded = false;
  std::vector<Branch> branches;  // actions that may still be the best
};

}  // namespace aos::point_based
