// States by number: two states that agree in every variable that matters have one number.
//
// Which variables do not matter follows from the text of the documents' code (lower_relevance.py), for every input.
// All others tell states apart. Most words of a state are the same in all states; they are compared, and only the
// others are hashed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "aos/model/reflection.hpp"

namespace aos {

inline constexpr std::uint32_t no_state = std::numeric_limits<std::uint32_t>::max();

template <class Model>
class StateNumbers {
 public:
  using State = typename Model::State;

  StateNumbers() : mask_(words(), ~std::uint64_t{0}), is_hashed_(words()) {
    for (const ByteRange& range : Model::irrelevant()) {
      std::memset(reinterpret_cast<std::byte*>(mask_.data()) + range.offset, 0, range.size);
    }
  }

  std::size_t size() const { return states_.size(); }
  const State& operator[](std::uint32_t number) const { return states_[number]; }

  // The number of a state, which is `size()` if it is new.
  std::uint32_t add(const State& state) {
    if (2 * states_.size() >= numbers_.size()) rehash(std::max<std::size_t>(4 * numbers_.size(), 256));
    if (!states_.empty() && !agrees_elsewhere(state)) tell_apart_by_more(state);
    std::uint32_t& number = numbers_[slot_of(state)];
    if (number == no_state) {
      number = static_cast<std::uint32_t>(states_.size());
      states_.push_back(state);
    }
    return number;
  }

  // `no_state` for a state that has no number.
  std::uint32_t find(const State& state) const {
    return states_.empty() || !agrees_elsewhere(state) ? no_state : numbers_[slot_of(state)];
  }

 private:
  static std::size_t words() { return (Model::state_bytes() + 7) / 8; }

  std::uint64_t word_of(const State& state, std::size_t word) const {
    std::uint64_t value = 0;
    std::memcpy(&value, Model::bytes_of(state) + 8 * word, std::min<std::size_t>(8, Model::state_bytes() - 8 * word));
    return value & mask_[word];
  }

  // Whether a state has what all have had so far, in the words that are not hashed.
  bool agrees_elsewhere(const State& state) const {
    std::uint64_t difference = 0;
    for (std::size_t word = 0; word < words(); ++word) {
      if (!is_hashed_[word]) difference |= word_of(state, word) ^ word_of(states_.front(), word);
    }
    return difference == 0;
  }
  void tell_apart_by_more(const State& state) {
    for (std::size_t word = 0; word < words(); ++word) {
      if (is_hashed_[word] || word_of(state, word) == word_of(states_.front(), word)) continue;
      is_hashed_[word] = true;
      hashed_.push_back(word);
    }
    rehash(numbers_.size());
  }

  // Open addressing, at most half full.
  std::size_t slot_of(const State& state) const {
    std::uint64_t hash = 0;
    for (const std::size_t word : hashed_) hash = mixed(hash, word_of(state, word));
    std::size_t slot = hash & (numbers_.size() - 1);
    while (numbers_[slot] != no_state && !is_same(states_[numbers_[slot]], state)) slot = (slot + 1) & (numbers_.size() - 1);
    return slot;
  }
  bool is_same(const State& left, const State& right) const {
    std::uint64_t difference = 0;
    for (const std::size_t word : hashed_) difference |= word_of(left, word) ^ word_of(right, word);
    return difference == 0;
  }
  void rehash(std::size_t slots) {
    numbers_.assign(slots, no_state);
    for (std::size_t number = 0; number < states_.size(); ++number) {
      numbers_[slot_of(states_[number])] = static_cast<std::uint32_t>(number);
    }
  }

  std::vector<std::uint64_t> mask_;
  std::vector<bool> is_hashed_;
  std::vector<std::size_t> hashed_;  // words in which any two states differ
  std::vector<State> states_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace aos
