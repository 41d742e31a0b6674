// Which values a search has seen, or which pairs of values: what is new is worth going on from (iterated width: Lipovetzky and
// Geffner, 2012).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>

#include "aos/base/mixed.hpp"

namespace aos {

class SeenCells {
 public:
  void clear() { seen_.clear(); }

  // Notes the value of one variable of `count` cells, or with width 2 its pairs with all others. Returns whether any is new.
  bool note(const std::uint64_t* cells, std::size_t count, std::size_t variable, int width) {
    const std::uint64_t atom = mixed(mixed(0, variable), cells[variable]);
    if (width == 1) return seen_.insert(atom).second;
    bool is_new = false;
    for (std::size_t other = 0; other < count; ++other) {
      if (other == variable) continue;
      const std::uint64_t second = mixed(mixed(0, other), cells[other]);
      is_new = seen_.insert(mixed(std::min(atom, second), std::max(atom, second))).second || is_new;
    }
    return is_new;
  }

 private:
  std::unordered_set<std::uint64_t> seen_;
};

}  // namespace aos
