// Numbers by 64-bit keys, for tables that are filled and emptied millions of times.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace aos::point_based {

// Open addressing, at most half full. The key of all ones is not to be used.
class NumberTable {
 public:
  // The number of a key, which is `number` from now on where there was none, and whether there was none.
  std::pair<std::uint32_t, bool> try_emplace(std::uint64_t key, std::uint32_t number) {
    if (2 * size_ >= entries_.size()) grow();
    Entry& entry = entries_[slot_of(key)];
    const bool is_new = entry.key == free_;
    if (is_new) {
      entry = {key, number};
      ++size_;
    }
    return {entry.number, is_new};
  }

  std::uint32_t size() const { return size_; }

  // Keeps its room.
  void clear() {
    std::fill(entries_.begin(), entries_.end(), Entry{});
    size_ = 0;
  }

 private:
  static constexpr std::uint64_t free_ = ~std::uint64_t{0};

  struct Entry {
    std::uint64_t key = free_;
    std::uint32_t number = 0;
  };

  std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t hash = key * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
    std::size_t slot = hash & (entries_.size() - 1);
    while (entries_[slot].key != free_ && entries_[slot].key != key) slot = (slot + 1) & (entries_.size() - 1);
    return slot;
  }

  void grow() {
    std::vector<Entry> before(std::max<std::size_t>(2 * entries_.size(), 64));
    before.swap(entries_);
    for (const Entry& entry : before) {
      if (entry.key != free_) entries_[slot_of(entry.key)] = entry;
    }
  }

  std::vector<Entry> entries_;
  std::uint32_t size_ = 0;
};

}  // namespace aos::point_based
