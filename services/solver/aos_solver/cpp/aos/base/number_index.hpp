// A hash table of numbers. A number stands for a thing that is stored elsewhere, and the thing's hash finds it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "aos/base/huge_pages.hpp"

namespace aos {

// Open addressing, at most half full. The caller's `is_it(number)` tells whether this number's thing is the one sought;
// the index asks it only about numbers with the same lower 32 bits of the hash. These bits must be well mixed.
class NumberIndex {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::uint32_t find(std::uint64_t hash, auto&& is_it) const {
    return entries_.empty() ? none : entries_[slot_of(hash, is_it)].number;
  }

  // Returns the thing's number if there is one. Otherwise adds `number` and returns it.
  std::uint32_t find_or_add(std::uint64_t hash, std::uint32_t number, auto&& is_it) {
    if (2 * size_ >= entries_.size()) grow();
    Entry& entry = entries_[slot_of(hash, is_it)];
    if (entry.number == none) {
      entry = {static_cast<std::uint32_t>(hash), number};
      ++size_;
    }
    return entry.number;
  }

  // Asks for the memory of a thing that is sought soon.
  [[gnu::always_inline]] void prefetch(std::uint64_t hash) const {
    if (!entries_.empty()) __builtin_prefetch(&entries_[static_cast<std::uint32_t>(hash) & (entries_.size() - 1)]);
  }

  std::uint32_t size() const { return size_; }

  // Keeps the memory.
  void clear() {
    if (size_ > 0) std::fill(entries_.begin(), entries_.end(), Entry{});
    size_ = 0;
  }

 private:
  struct Entry {
    std::uint32_t hash = 0;
    std::uint32_t number = none;
  };

  using Entries = std::vector<Entry, HugePages<Entry>>;

  std::size_t slot_of(std::uint64_t whole_hash, auto&& is_it) const {
    const auto hash = static_cast<std::uint32_t>(whole_hash);
    std::size_t slot = hash & (entries_.size() - 1);
    while (entries_[slot].number != none && (entries_[slot].hash != hash || !is_it(entries_[slot].number))) {
      slot = (slot + 1) & (entries_.size() - 1);
    }
    return slot;
  }

  void grow() {
    Entries before(std::max<std::size_t>(2 * entries_.size(), 64));
    before.swap(entries_);
    for (const Entry& entry : before) {
      if (entry.number != none) entries_[slot_of(entry.hash, [](std::uint32_t) { return false; })] = entry;
    }
  }

  Entries entries_;
  std::uint32_t size_ = 0;
};

}
