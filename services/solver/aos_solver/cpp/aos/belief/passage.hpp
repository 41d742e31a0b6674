// The blocks of a trace with the states after them, as far as these are known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "aos/belief/history.hpp"

namespace aos {

template <class Model>
class Passage {
 public:
  using State = typename Model::State;

  // What came of a block that was repeated as it is: the density of the numbers, and for a guided step a digest of the
  // weights that it has drawn from.
  struct Repeated {
    double likelihood;
    std::uint64_t digest;
  };
  struct Place {
    const Block* block = nullptr;
    std::uint32_t draws = 0;  // those of the block, beside its address so that it is looked at only where it is run
    bool is_repeated = false;
    Repeated repeated = {};
  };

  bool empty() const { return places_.empty(); }
  void begin(const TraceLink& trace) {
    places_.clear();
    states_.clear();
    draws_ = 0;
    std::size_t count = 0;
    for (const Trace* block = trace.get(); block != nullptr; block = block->before.get()) ++count;
    places_.resize(count);
    take(trace, 0);
  }

  std::size_t size() const { return places_.size(); }
  const Block& block(std::size_t place) const { return *places_[place].block; }
  std::size_t draws_of(std::size_t place) const { return places_[place].draws; }
  std::size_t draws() const { return draws_; }

  // Fetches into the processor's cache what any proposal looks at. The passages of all copies are more than it holds.
  void prefetch() const {
    for (std::size_t place = 0; place < places_.size(); ++place) __builtin_prefetch(&places_[place]);
    if (!states_.empty()) __builtin_prefetch(states_.data());
  }

  // After how many blocks the state is known.
  std::size_t passed() const { return states_.size(); }
  const State& state(std::size_t place) const { return states_[place]; }
  bool is_repeated(std::size_t place) const { return places_[place].is_repeated; }
  const Repeated& repeated(std::size_t place) const { return places_[place].repeated; }
  // Notes what came of a block, the first one after those that were passed, or one of these.
  void note(std::size_t place, const State& state, Repeated repeated) {
    if (place == states_.size()) states_.push_back(state);
    places_[place].is_repeated = true;
    places_[place].repeated = repeated;
  }

  // Another trace, which differs from `place` on; the states after its blocks from there on. A refreshed one has other states
  // and was repeated with these likelihoods, and its later blocks draw from the same weights as before.
  void replace(std::size_t place, const TraceLink& trace, const std::vector<State>& states) {
    take(trace, place);
    states_.resize(place);
    states_.insert(states_.end(), states.begin(), states.end());
  }
  void refresh(const TraceLink& trace, const std::vector<State>& states, const std::vector<double>& likelihoods) {
    replace(0, trace, states);
    for (std::size_t place = 1; place < places_.size(); ++place) {
      places_[place].is_repeated = true;
      places_[place].repeated.likelihood = likelihoods[place - 1];
    }
  }

 private:
  // Takes the blocks of a trace from a place on.
  void take(const TraceLink& trace, std::size_t from) {
    const Trace* next = trace.get();
    for (std::size_t place = places_.size(); place-- > from; next = next->before.get()) {
      draws_ += next->block.draws;
      draws_ -= places_[place].draws;
      places_[place].block = &next->block;
      places_[place].draws = next->block.draws;
      places_[place].is_repeated = false;
    }
  }

  std::vector<Place> places_;
  std::vector<State> states_;
  std::size_t draws_ = 0;
};

}  // namespace aos
