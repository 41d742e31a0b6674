// The states that some decisions can lead to from a belief, where there are too many in all: a battery that is never empty, a
// count of steps. A search with a horizon needs no others.
#pragma once

#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "point_based/flat_model.hpp"

namespace aos {

template <class Model>
class NearStates {
 public:
  // Lists what `decisions` decisions can lead to from a belief, and half as many more, so that it serves later beliefs as well.
  // Returns whether that is listed.
  bool reach(const Belief<Model>& belief, int decisions) {
    if (decisions_from(belief) >= decisions) return true;
    if (2 * belief.particles().size() > given_up_with_) return false;
    const bool is_listed = comes_to_an_end([&] {
      space_.limit(lists_ == 0 ? first_limits : later_limits);
      ++lists_;
      decisions_ = space_.reach_near(belief, decisions, decisions + (decisions + 1) / 2);
      measure_distances(belief);
    });
    given_up_with_ = is_listed ? any_number : belief.particles().size();
    if (!is_listed) decisions_ = 0;
    return is_listed;
  }

  // The listed states. Those that are reached last have no outcomes and earn nothing.
  const StateSpace<Model>& space() const { return space_; }

  // Begins another mission, which lists what the first one has listed.
  void start_over() {
    if (lists_ > 1) decisions_ = 0;
    lists_ = 0;
    given_up_with_ = any_number;
  }

 private:
  static constexpr ListLimits first_limits{.states = 100'000, .outcomes = 3'000'000, .work = 10'000'000};
  static constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

  // How many decisions from a belief are listed; none from one with another state.
  int decisions_from(const Belief<Model>& belief) const {
    if (decisions_ == 0) return 0;
    int farthest = 0;
    for (const auto& [number, weight] : space_.weights_of(belief)) {
      if (number == no_state) return 0;
      farthest = std::max(farthest, distances_[number]);
    }
    return decisions_ - farthest;
  }

  // States have their numbers in the order in which they were reached.
  void measure_distances(const Belief<Model>& belief) {
    distances_.assign(space_.size(), std::numeric_limits<int>::max());
    for (const auto& [number, weight] : space_.weights_of(belief)) distances_[number] = 0;
    for (std::size_t state = 0; state < space_.size(); ++state) {
      for (const point_based::Outcome& outcome : space_.rows().outcomes_of(state)) {
        distances_[outcome.next] = std::min(distances_[outcome.next], distances_[state] + 1);
      }
    }
  }

  StateSpace<Model> space_;
  List<int> distances_;  // of states from the belief of the list, in decisions
  int decisions_ = 0;           // that are listed from that belief
  int lists_ = 0;               // of this mission
  std::size_t given_up_with_ = any_number;  // states of the belief
};

}
