// Lists the states that can be reached, and walks what each action does in them. Who lists keeps the outcomes in a form of
// its own: state_space.hpp with what is observed, wide_values.hpp without, in few bytes.
//
// Limits are in numbers and work, not in time, so that decisions repeat.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/planning/listed/state_numbers.hpp"

namespace aos {

struct ListLimits {
  std::size_t states = 400'000;
  std::size_t bytes = std::size_t{100} << 20;  // of states
  std::size_t outcomes = 12'000'000;           // in elements of the form in which they are kept
  std::size_t work = 30'000'000;               // of one call, in draws and copies of 64 bytes: one to two seconds
};

inline constexpr std::uint32_t states_between_looks = 256;  // at the progress

template <class Model>
class StateLister {
 public:
  using State = typename Model::State;

  explicit StateLister(const ListLimits& limits) : limits_(limits) {}

  void limit(const ListLimits& limits) { limits_ = limits; }
  const ListLimits& limits() const { return limits_; }
  const StateNumbers<Model>& numbers() const { return numbers_; }
  Enumerator& draws() { return draws_; }
  // Work since `begin`.
  std::size_t work() const { return work_; }
  void begin() { work_ = 0; }
  bool reaches(Ending ending) const { return reached_[static_cast<std::size_t>(ending)]; }
  // The largest probability of a step that was left out.
  double most_left_out() const { return most_left_out_; }

  // The number of a running state. Throws NotEnumerable at a limit.
  std::uint32_t add(const State& state) {
    const std::uint32_t number = numbers_.add(state);
    if (numbers_.size() > limits_.states || numbers_.bytes() > limits_.bytes) {
      throw NotEnumerable{"there are too many states to list"};
    }
    return number;
  }

  // Adds the running states of a belief. If most states of a drawn belief were drawn only once, there are more: NotEnumerable.
  void add_states_of(const Belief<Model>& belief) {
    begin();
    const std::size_t before = numbers_.size();
    for (const auto& [state, weight] : belief.particles()) {
      if (goes_on(state)) add(state);
    }
    if (belief.is_mostly_drawn_once() && before == 0 && 2 * numbers_.size() > belief.particles().size()) {
      throw NotEnumerable{"nearly all states of the belief differ"};
    }
  }

  // Calls `found(next, step, probability)` for each path of an action after which the mission goes on. Returns the expected
  // reward. Throws NotEnumerable at a limit.
  double walk(const State& state, int action, auto&& found) {
    double reward = 0;
    const auto run = [&](Enumerator& path) {
      work_ += work_of_step(path, Model::state_bytes());
      if (work_ > limits_.work) throw NotEnumerable{"there are too many outcomes to list"};
      next_ = state;
      step_ = Model::step(next_, action, path);
    };
    const double left_out = draws_.for_nearly_each_path(run, [&](Enumerator& path) {
      reward += path.probability() * step_.reward;
      if (goes_on(next_)) found(std::as_const(next_), std::as_const(step_), path.probability());
    });
    most_left_out_ = std::max(most_left_out_, left_out);
    return reward;
  }

 private:
  bool goes_on(const State& state) {
    const Ending ending = Model::ending(state);
    reached_[static_cast<std::size_t>(ending)] = true;
    return ending == Ending::running;
  }

  ListLimits limits_;
  StateNumbers<Model> numbers_;
  Enumerator draws_;
  State next_;  // to which the last run led
  Step step_;
  std::size_t work_ = 0;
  double most_left_out_ = 0;
  bool reached_[ending_count]{};
};

}
