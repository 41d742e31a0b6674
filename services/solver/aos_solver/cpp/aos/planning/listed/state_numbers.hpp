// States by number. Two states that agree in every relevant variable have the same number.
//
// Which variables are irrelevant follows from the text of the documents' code (lowering/relevance.py), for every input.
// Most words of a state are the same in all states. These words are kept once, and only the others for each state.
#pragma once

#include <optional>

#include "aos/base/mixed.hpp"
#include "aos/base/number_index.hpp"
#include "aos/model/reflection.hpp"

namespace aos {

inline constexpr std::uint32_t no_state = NumberIndex::none;

template <class Model>
class StateNumbers {
 public:
  using State = typename Model::State;

  StateNumbers() {
    const std::size_t bytes = Model::state_bytes();
    List<unsigned char> mask(bytes, 0xff);
    for (const ByteRange& range : Model::irrelevant()) std::memset(mask.data() + range.offset, 0, range.size);
    for (std::size_t begin = 0; begin < bytes; begin += 8) {
      const std::size_t size = std::min<std::size_t>(8, bytes - begin);
      // The last word begins earlier, where it would reach beyond the state. Only the rest of it counts.
      Word word{std::min(begin, std::max<std::size_t>(bytes, 8) - 8), 0, 0};
      std::memcpy(reinterpret_cast<std::byte*>(&word.mask) + (begin - word.offset), &mask[begin], size);
      if (word.mask != 0) same_.push_back(word);
    }
  }

  std::size_t size() const { return size_; }
  // What all states take, without the index.
  std::size_t bytes() const { return kept_.size() * sizeof(std::uint64_t); }
  // The state with a number. Its irrelevant variables are those of the first state.
  State operator[](std::uint32_t number) const {
    State state = *first_;
    for (std::size_t i = 0; i < words_.size(); ++i) write(state, words_[i], kept_of(number, i));
    return state;
  }

  // Whether two states have the same number.
  bool are_same(const State& left, const State& right) const {
    const auto agree = [&](const Word& word) { return read(left, word) == read(right, word); };
    return std::ranges::all_of(words_, agree) && std::ranges::all_of(same_, agree);
  }

  // The number of a state, which is `size()` if the state is new.
  std::uint32_t add(const State& state) {
    if (!first_) begin(state);
    if (!agrees_elsewhere(state)) tell_apart_by_more(state);
    const std::uint32_t number = numbers_.find_or_add(hash_of(state), size_, is_same_as(state));
    if (number < size_) return number;
    for (const Word& word : words_) kept_.push_back(read(state, word));
    return size_++;
  }

  // Asks for the memory of a state that is added soon.
  [[gnu::always_inline]] void prefetch(const State& state) const { numbers_.prefetch(hash_of(state)); }

  // The number of a state; `no_state` if it has none.
  std::uint32_t find(const State& state) const {
    if (!first_ || !agrees_elsewhere(state)) return no_state;
    return numbers_.find(hash_of(state), is_same_as(state));
  }

 private:
  // Eight bytes of a state, of which those in the mask matter.
  struct Word {
    std::size_t offset;
    std::uint64_t mask;
    std::uint64_t first;  // in the first state
  };

  static std::uint64_t read(const State& state, const Word& word) {
    std::uint64_t value;
    std::memcpy(&value, Model::bytes_of(state) + word.offset, sizeof value);
    return value & word.mask;
  }
  static void write(State& state, const Word& word, std::uint64_t kept) {
    std::byte* const place = Model::bytes_of(state) + word.offset;
    std::uint64_t value;
    std::memcpy(&value, place, sizeof value);
    value = (value & ~word.mask) | kept;
    std::memcpy(place, &value, sizeof value);
  }

  void begin(const State& state) {
    first_ = state;
    for (Word& word : same_) word.first = read(state, word);
  }

  // Whether a state agrees with all earlier ones in the words that are not kept.
  bool agrees_elsewhere(const State& state) const {
    std::uint64_t difference = 0;
    for (const Word& word : same_) difference |= read(state, word) ^ word.first;
    return difference == 0;
  }
  void tell_apart_by_more(const State& state) {
    const std::size_t before = words_.size();
    const auto differs = [&](const Word& word) { return read(state, word) != word.first; };
    std::ranges::copy_if(same_, std::back_inserter(words_), differs);
    erase_if(same_, differs);
    List<std::uint64_t> kept;
    kept.reserve(size_ * words_.size());
    for (std::size_t number = 0; number < size_; ++number) {
      for (std::size_t i = 0; i < words_.size(); ++i) {
        kept.push_back(i < before ? kept_[number * before + i] : words_[i].first);
      }
    }
    kept_ = std::move(kept);
    numbers_.clear();
    for (std::uint32_t number = 0; number < size_; ++number) {
      const std::uint64_t hash = hash_of_words([&](std::size_t i) { return kept_of(number, i); });
      numbers_.find_or_add(hash, number, [](std::uint32_t) { return false; });
    }
  }

  std::uint64_t kept_of(std::uint32_t number, std::size_t i) const { return kept_[number * words_.size() + i]; }
  std::uint64_t hash_of_words(auto&& word_at) const {
    std::uint64_t hash = 0;
    for (std::size_t i = 0; i < words_.size(); ++i) hash = mixed(hash, word_at(i));
    return hash;
  }
  std::uint64_t hash_of(const State& state) const {
    return hash_of_words([&](std::size_t i) { return read(state, words_[i]); });
  }
  auto is_same_as(const State& state) const {
    return [&](std::uint32_t number) {
      std::uint64_t difference = 0;
      for (std::size_t i = 0; i < words_.size(); ++i) difference |= kept_of(number, i) ^ read(state, words_[i]);
      return difference == 0;
    };
  }

  std::optional<State> first_;
  List<Word> same_;           // in all states
  List<Word> words_;          // which tell states apart
  List<std::uint64_t> kept_;  // these words, state by state
  std::uint32_t size_ = 0;
  NumberIndex numbers_;
};

}
