// Which values a search has seen, or which pairs of values: what is new is worth going on from (iterated width: Lipovetzky and
// Geffner, 2012).
#pragma once

#include "aos/base/mixed.hpp"

namespace aos {

// Notes in `seen` the values of those of `count` variables that are looked at, or with width 2 their pairs with all others, or with width 3
// these with one more. Returns whether any is new.
bool note_cells(auto& seen, const std::uint64_t* cells, std::size_t count, int width, auto&& is_looked_at) {
  thread_local List<std::uint64_t> atoms;
  atoms.clear();
  bool is_new = false;
  for (std::size_t variable = 0; variable < count; ++variable) {
    if (!is_looked_at(variable)) continue;
    const auto atom_of = [&](std::size_t each) { return mixed(mixed(0, each), cells[each]); };
    if (width == 1) {
      is_new = seen.insert(atom_of(variable)) || is_new;
      continue;
    }
    for (std::size_t each = atoms.size(); each < count; ++each) atoms.push_back(atom_of(each));
    const std::uint64_t atom = atoms[variable];
    for (std::size_t other = 0; other < count; ++other) {
      if (other == variable) continue;
      const std::uint64_t pair = mixed(std::min(atom, atoms[other]), std::max(atom, atoms[other]));
      if (width == 2) is_new = seen.insert(pair) || is_new;
      for (std::size_t third = other + 1; width == 3 && third < count; ++third) {
        if (third != variable) is_new = seen.insert(atom + mixed(0, atoms[other] + atoms[third])) || is_new;
      }
    }
  }
  return is_new;
}

// A set of numbers that are well mixed: open addressing, at most half full. 0 is taken for 1.
class SeenCells {
 public:
  void clear() { *this = {}; }
  // Notes a value. Returns whether it is new.
  bool insert(std::uint64_t value) {
    value = std::max<std::uint64_t>(value, 1);
    std::uint64_t& slot = slot_of(value);
    if (slot == value) return false;
    slot = value;
    if (2 * ++size_ > slots_.size()) grow();
    return true;
  }

 private:
  std::uint64_t& slot_of(std::uint64_t value) {
    std::size_t slot = value & (slots_.size() - 1);
    while (slots_[slot] != 0 && slots_[slot] != value) slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot];
  }
  void grow() {
    const List<std::uint64_t> before = std::exchange(slots_, List<std::uint64_t>(4 * slots_.size()));
    for (const std::uint64_t value : before) {
      if (value != 0) slot_of(value) = value;
    }
  }

  List<std::uint64_t> slots_ = List<std::uint64_t>(1 << 10);
  std::size_t size_ = 0;
};

// The same in a table of bits, which is faster. Of two values with one bit the second counts as seen.
class SeenBits {
 public:
  bool insert(std::uint64_t value) {
    std::uint64_t& word = words_[value / 64 % words_.size()];
    const std::uint64_t bit = std::uint64_t{1} << value % 64;
    return (std::exchange(word, word | bit) & bit) == 0;
  }

 private:
  List<std::uint64_t> words_ = List<std::uint64_t>(1 << 12);
};

}
