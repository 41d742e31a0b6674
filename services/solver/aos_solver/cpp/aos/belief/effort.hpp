// What a belief update takes, in counts, so that a mission can tell why it took long.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

namespace aos {

struct UpdateEffort {
  std::size_t steps = 0;   // of the model
  std::size_t traced = 0;  // earlier steps that particles have taken again
  std::size_t moves = 0;   // of all particles
  std::size_t moved = 0;   // particles, at most
  double fewest = std::numeric_limits<double>::infinity();  // effective samples before moves

  void note_move(std::size_t particles, double effective, std::size_t steps_of_model) {
    ++moves;
    moved = std::max(moved, particles);
    fewest = std::min(fewest, effective);
    steps += steps_of_model;
  }

  std::string text() const {
    std::string told = std::to_string(steps) + " steps of the model";
    if (traced > 0) told += "; " + std::to_string(traced) + " earlier steps were repeated";
    if (moves == 0) return told;
    return told + "; " + std::to_string(moved) + " particles were moved " + (moves == 1 ? "once" : std::to_string(moves) + " times") +
           ", as only " + std::to_string(std::llround(fewest)) + " effective samples were left";
  }
};

inline thread_local constinit UpdateEffort update_effort;

}
