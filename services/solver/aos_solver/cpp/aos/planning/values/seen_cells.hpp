// Which values a search has seen, or which pairs of values: what is new is worth going on from (iterated width: Lipovetzky and
// Geffner, 2012).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "aos/base/mixed.hpp"

namespace aos {

class SeenCells {
 public:
  void clear() { seen_.clear(); }

  // Notes the value of one variable of `count` cells, or with width 2 its pairs with all others. Returns whether any is new.
  bool note(const std::uint64_t* cells, std::size_t count, std::size_t variable, int width) {
    return note_in(cells, count, variable, width, [this](std::uint64_t value) { return seen_.insert(value).second; });
  }

  // The same; `insert` notes a value or pair, and says whether it is new.
  template <class Insert>
  static bool note_in(const std::uint64_t* cells, std::size_t count, std::size_t variable, int width, Insert&& insert) {
    const std::uint64_t atom = mixed(mixed(0, variable), cells[variable]);
    if (width == 1) return insert(atom);
    bool is_new = false;
    for (std::size_t other = 0; other < count; ++other) {
      if (other == variable) continue;
      const std::uint64_t second = mixed(mixed(0, other), cells[other]);
      is_new = insert(mixed(std::min(atom, second), std::max(atom, second))) || is_new;
    }
    return is_new;
  }

 private:
  std::unordered_set<std::uint64_t> seen_;
};

// The same in a table of bits, which is faster. Of two values with one bit the second counts as seen.
class SeenBits {
 public:
  bool note(const std::uint64_t* cells, std::size_t count, std::size_t variable, int width) {
    return SeenCells::note_in(cells, count, variable, width, [this](std::uint64_t value) {
      std::uint64_t& word = words_[value / 64 % words_.size()];
      const std::uint64_t bit = std::uint64_t{1} << value % 64;
      const bool is_new = (word & bit) == 0;
      word |= bit;
      return is_new;
    });
  }

 private:
  std::vector<std::uint64_t> words_ = std::vector<std::uint64_t>(1 << 12);
};

}  // namespace aos
