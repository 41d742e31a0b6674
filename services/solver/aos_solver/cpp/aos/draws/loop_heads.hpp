// What model code tells a source of draws of the loops in which it draws: see model/drawing_loop.hpp.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace aos {

// Thrown out of model code where the rest of a path is walked elsewhere.
struct CutPath {};

// Thrown out of model code that goes round in this loop for ever, whatever it draws.
struct EndlessPath {
  std::uint32_t loop;
};

// Thrown out of model code whose loop has taken as many rounds as are allowed, where nobody is told of heads.
struct LongLoop {
  std::uint32_t loop;
};
inline constexpr std::uint32_t any_rounds = std::numeric_limits<std::uint32_t>::max();
inline thread_local std::uint32_t allowed_rounds = any_rounds;
// Throws a LongLoop where somebody should look whether the loop has an end.
void look_whether_it_ends(std::uint32_t loop, std::uint32_t rounds);

// Called where document code catches everything, `catch (...)`. Throws again what ends a path, which the code cannot mean.
void let_paths_end();

class LoopHeads {
 public:
  // Called where a loop begins. Returns a number for the way there: different ways have different numbers.
  virtual std::uint32_t enter() = 0;
  // Called before each round of a loop. Returns where to write all that the loop may change, and `cut` is called then.
  // It returns null if the path goes on.
  virtual std::string* arrive(std::uint32_t loop, std::uint32_t entry) = 0;
  // Throws a CutPath.
  [[noreturn]] virtual void cut() = 0;

 protected:
  ~LoopHeads() = default;
};

}
