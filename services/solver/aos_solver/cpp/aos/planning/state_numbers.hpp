// States by number. Two states that agree in every relevant variable have the same number.
//
// Which variables are irrelevant follows from the text of the documents' code (lower_relevance.py), for every input.
// Most words of a state are the same in all states. These words are compared, and only the others are hashed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "aos/base/number_index.hpp"
#include "aos/model/reflection.hpp"

namespace aos {

inline constexpr std::uint32_t no_state = NumberIndex::none;

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

  // The number of a state, which is `size()` if the state is new.
  std::uint32_t add(const State& state) {
    if (!states_.empty() && !agrees_elsewhere(state)) tell_apart_by_more(state);
    const auto known = static_cast<std::uint32_t>(states_.size());
    const std::uint32_t number = numbers_.find_or_add(hash_of(state), known, is_same_as(state));
    if (number == known) states_.push_back(state);
    return number;
  }

  // The number of a state; `no_state` if it has none.
  std::uint32_t find(const State& state) const {
    if (states_.empty() || !agrees_elsewhere(state)) return no_state;
    return numbers_.find(hash_of(state), is_same_as(state));
  }

 private:
  static std::size_t words() { return (Model::state_bytes() + 7) / 8; }

  std::uint64_t word_of(const State& state, std::size_t word) const {
    std::uint64_t value = 0;
    std::memcpy(&value, Model::bytes_of(state) + 8 * word, std::min<std::size_t>(8, Model::state_bytes() - 8 * word));
    return value & mask_[word];
  }

  // Whether a state agrees with all earlier ones in the words that are not hashed.
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
    numbers_.clear();
    for (std::uint32_t number = 0; number < states_.size(); ++number) {
      numbers_.find_or_add(hash_of(states_[number]), number, is_same_as(states_[number]));
    }
  }

  std::uint64_t hash_of(const State& state) const {
    std::uint64_t hash = 0;
    for (const std::size_t word : hashed_) hash = mixed(hash, word_of(state, word));
    return hash;
  }
  auto is_same_as(const State& state) const {
    return [&](std::uint32_t number) {
      std::uint64_t difference = 0;
      for (const std::size_t word : hashed_) difference |= word_of(states_[number], word) ^ word_of(state, word);
      return difference == 0;
    };
  }

  std::vector<std::uint64_t> mask_;
  std::vector<bool> is_hashed_;
  std::vector<std::size_t> hashed_;  // the words in which some states differ
  std::vector<State> states_;
  NumberIndex numbers_;
};

}  // namespace aos
