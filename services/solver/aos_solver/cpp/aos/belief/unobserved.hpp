// What a state might be had nothing been observed: states drawn from the initial belief, after the same actions.
//
// Particles that have survived many observations share their ancestors: what has not been observed yet has by chance the
// same value in all of them, and a later observation may rule out that value. Here it still has all its values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "aos/base/fault.hpp"
#include "aos/base/random.hpp"
#include "aos/model/step.hpp"
#include "aos/model/values.hpp"

namespace aos {

template <class Model>
class Unobserved {
 public:
  using State = typename Model::State;
  static constexpr std::size_t most_bytes = std::size_t{8} << 20;
  static std::size_t most_states() { return std::clamp<std::size_t>(most_bytes / Model::state_bytes(), 1, 1000); }

  Unobserved() = default;
  // One that was kept with these states, of this model or of one with the same states before it. What is open is found
  // among them and by drawing from the initial belief again.
  Unobserved(std::vector<State> states, Sampler& random) {
    State initial{};
    for (std::size_t i = 0; i < most_states() && !states.empty(); ++i) {
      Model::initial(initial, random);
      add(initial);
    }
    states_ = std::move(states);
    for (const State& state : states_) note_differences(state);
  }

  bool is_empty() const { return states_.empty(); }
  const std::vector<State>& states() const { return states_; }

  // A state from the initial belief; those after the first `most_states()` are not needed.
  void add(const State& initial) {
    if (states_.size() == most_states()) return;
    states_.push_back(initial);
    note_differences(initial);
  }

  // Whether what stands there has ever differed between two states: at the beginning, or after some action.
  bool is_open(const Place& place) const {
    if (is_empty()) return false;
    const auto begin = differences_.begin() + static_cast<std::ptrdiff_t>(place.offset);
    const auto end = begin + static_cast<std::ptrdiff_t>(place.size);
    return std::any_of(begin, end, [](std::byte difference) { return difference != std::byte{0}; });
  }

  const State& draw(Sampler& random) const {
    return states_[static_cast<std::size_t>(random.below(static_cast<int>(states_.size())))];
  }

  // The same for a model with the same states.
  template <class To>
  Unobserved<To> as() const {
    Unobserved<To> result;
    result.states_ = states_;
    result.differences_ = differences_;
    return result;
  }

  // A state that ends, or that the action makes no sense in, makes room for another one, as long as there is one.
  void step(int action, Sampler& random) {
    std::size_t running = 0;
    for (State& state : states_) {
      if (goes_on(state, action, random)) std::swap(states_[running++], state);
    }
    if (running == 0) return;
    for (std::size_t i = running; i < states_.size(); ++i) {
      states_[i] = states_[static_cast<std::size_t>(random.below(static_cast<int>(running)))];
    }
    for (const State& state : states_) note_differences(state);
  }

 private:
  template <class>
  friend class Unobserved;

  void note_differences(const State& state) {
    const std::byte* const first = Model::bytes_of(states_.front());
    const std::byte* const other = Model::bytes_of(state);
    differences_.resize(Model::state_bytes());
    for (std::size_t i = 0; i < differences_.size(); ++i) differences_[i] |= first[i] ^ other[i];
  }

  static bool goes_on(State& state, int action, Sampler& random) {
    try {
      Model::step(state, action, random);
    } catch (const ModelFault&) {
      return false;
    }
    return Model::ending(state) == Ending::running;
  }

  std::vector<State> states_;
  std::vector<std::byte> differences_;  // by byte of a state; 0 where all states have always had the same
};

}  // namespace aos
