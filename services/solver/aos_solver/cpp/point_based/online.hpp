// SARSOP during a mission: from the belief of each decision, with all that earlier ones have found out.
//
// The one header of this folder that the engine's templates include; what is behind it is an object file of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "point_based/flat_model.hpp"

namespace aos::point_based {

// What an action is worth at least and at most, and how many trials began with it.
struct ActionBounds {
  double lower = 0;
  double upper = 0;
  std::uint32_t trials = 0;
};

// A lower bound is above an upper one: a mistake in this folder, whatever the model.
struct CrossedBounds : std::logic_error {
  using std::logic_error::logic_error;
};

class OnlineSarsop {
 public:
  using IsOver = std::function<bool()>;

  // Works out the first bounds. Without a horizon the discount must be below 1.
  // Throws std::length_error where there are too many states for so long a horizon.
  explicit OnlineSarsop(FlatModel model);
  ~OnlineSarsop();

  // Forgets all that trials have found out; keeps the first bounds.
  void start_over();

  // Goes on from a belief, by state, with the whole horizon to go. Its probabilities may sum to less than 1: what is
  // missing is worth nothing. Returns whether it is one that the model's starts can lead to.
  bool move_to(const std::vector<std::pair<std::uint32_t, double>>& belief);

  // Runs trials, one at least, until `is_over()`, until so much work is done (0: no limit), or until nothing is left to
  // find out. Returns the work: how many numbers were multiplied, of states by what they lead to or by alpha vectors.
  std::uint64_t improve(std::uint64_t max_work, const IsOver& is_over);
  // The same below an action that is carried out, without a limit of the work.
  std::uint64_t improve_below(std::uint32_t action, const IsOver& is_over);

  // Of all actions, of the belief moved to; discounted, of so many decisions as the horizon has.
  // These and `bounds` hold as they stand, rounding included.
  std::vector<ActionBounds> action_bounds();
  // What the belief moved to is worth at least and at most. Throws CrossedBounds.
  std::pair<double, double> bounds();

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace aos::point_based
