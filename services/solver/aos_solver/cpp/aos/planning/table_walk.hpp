// Random walks by the table of a model with few states: see walk.hpp for those by its code.
#pragma once

#include <array>
#include <cstdint>

#include "aos/base/random.hpp"
#include "aos/model/walk.hpp"
#include "aos/planning/step_table.hpp"

namespace aos {

// Many walks side by side, from the belief that the table was prepared for, each with a new start at the end and at the
// horizon. A processor works on several of them at a time, since none waits for another.
template <class Model>
class TableWalks {
 public:
  static constexpr std::uint64_t count = 64;

  TableWalks(const StepTable<Model>& table, Sampler& random) : table_(table) {
    for (Walk& walk : walks_) start(walk, random);
  }

  // At least so many steps.
  Walked walk(std::uint64_t steps, Sampler& random) {
    Sampler draws = random;  // what nothing else points to, a compiler keeps in registers
    Walked walked;
    for (; walked.steps < steps; walked.steps += count) {
      for (Walk& walk : walks_) walked.rewards += step(walk, draws);
    }
    random = draws;
    return walked;
  }

 private:
  struct Walk {
    std::uint32_t state;
    std::int32_t left;
  };

  void start(Walk& walk, Sampler& random) {
    do walk.state = table_.start(random.bits());
    while (walk.state == StepTable<Model>::ended);
    walk.left = Model::horizon;
  }

  // What is left of a random number that has chosen the action chooses what comes of it.
  double step(Walk& walk, Sampler& random) {
    const auto product = static_cast<unsigned __int128>(random.bits()) * static_cast<unsigned>(Model::action_count());
    const auto& outcome =
        table_.outcome(walk.state, static_cast<int>(product >> 64), static_cast<std::uint64_t>(product));
    walk.state = outcome.next;
    if (--walk.left == 0 || walk.state == StepTable<Model>::ended) [[unlikely]] start(walk, random);
    return outcome.step.reward;
  }

  const StepTable<Model>& table_;
  std::array<Walk, count> walks_;
};

}  // namespace aos
