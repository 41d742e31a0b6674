// The blocks of a trace with the states after them, as far as these are known.
#pragma once

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
    std::unique_ptr<const Block> own = nullptr;  // the block, where it is not of the trace at the beginning
  };

  bool empty() const { return places_.empty(); }
  void begin(const TraceLink& trace) {
    places_.clear();
    states_.clear();
    draws_ = 0;
    std::size_t count = 0;
    for (const Trace* next = trace.get(); next != nullptr; next = next->before.get()) ++count;
    places_.resize(count);
    for (const Trace* next = trace.get(); next != nullptr; next = next->before.get()) {
      Place& place = places_[--count];
      place.block = &next->block;
      place.draws = next->block.draws;
      draws_ += place.draws;
    }
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

  // Other blocks from `place` on, and the states after them.
  void replace(std::size_t place, List<Block>& blocks, const List<State>& states) {
    for (std::size_t i = 0; i < blocks.size(); ++i) set(place + i, std::move(blocks[i]));
    states_.resize(place);
    states_.insert(states_.end(), states.begin(), states.end());
  }
  // Another block, with the same state after it.
  void replace(std::size_t place, Block block) { set(place, std::move(block)); }
  // Another origin, and the states after it. The later blocks were repeated with these likelihoods, and draw from the same
  // weights as before.
  void refresh(Block origin, const List<State>& states, const List<double>& likelihoods) {
    set(0, std::move(origin));
    states_ = states;
    for (std::size_t place = 1; place < places_.size(); ++place) {
      places_[place].is_repeated = true;
      places_[place].repeated.likelihood = likelihoods[place - 1];
    }
  }

  // The trace of these blocks; `trace` is that of the beginning.
  TraceLink trace(TraceLink trace) const {
    std::size_t same = 0;
    while (same < places_.size() && places_[same].own == nullptr) ++same;
    for (std::size_t i = same; i < places_.size(); ++i) trace = trace->before;
    for (std::size_t i = same; i < places_.size(); ++i) {
      trace = i == 0 ? begun_trace(*places_[i].block) : longer(std::move(trace), *places_[i].block);
    }
    return trace;
  }

 private:
  void set(std::size_t place, Block block) {
    Place& changed = places_[place];
    draws_ += block.draws;
    draws_ -= changed.draws;
    changed.draws = block.draws;
    changed.own = std::make_unique<const Block>(std::move(block));
    changed.block = changed.own.get();
    changed.is_repeated = false;
  }

  List<Place> places_;
  List<State> states_;
  std::size_t draws_ = 0;
};

}
