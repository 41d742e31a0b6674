// The way to an end that can be had at once, and that earns more if something is done before.
//
// Where an end pays for all that is in order, a search for ways stops at the end itself. Here the end is put off by the action
// after which an end earns most, and again, as long as that gains something. The state is seen.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_search.hpp"

namespace aos {

template <class Model>
class BestEnd {
 public:
  using State = typename Model::State;

  BestEnd(const DecisionClock& clock, const RunningDown<Model>* retries) : clock_(clock), retries_(retries) {}

  // The way from a state to the end of the mission; empty if no action ends the mission at once without a failure, or if nothing is
  // earned in all. `steps` of the model are counted down.
  Option way_from(const State& start, double& steps, Sampler& random) const {
    const List<int> exits = exits_from(start, steps, random);
    State state = start;
    Option way;
    End end = best_end(state, exits, steps, random);
    while (end.action >= 0 && way.size() < most_before_end && steps > 0 && !clock_.is_over()) {
      const int action = put_off(state, end, exits, steps, random);
      if (action < 0) break;
      way.push_back(action);
      end = best_end(state, exits, steps, random);
    }
    if (end.action < 0) return {};
    way.push_back(end.action);
    double earned = 0;
    for (int i = 0; i < tries; ++i, steps -= way.size()) {
      State next = start;
      earned += taken_option<Model>(way, next, random, retries_).earned;
    }
    return earned > 0 ? way : Option{};
  }

 private:
  static constexpr std::size_t most_before_end = 40;  // actions
  static constexpr std::size_t most_exits = 4;
  static constexpr int tries = 4;  // of the way

  struct End {
    int action = -1;  // none ends the mission
    double earned = 0;
  };

  // The actions that end the mission at once without a failure: those that earn most.
  List<int> exits_from(const State& start, double& steps, Sampler& random) const {
    List<End> ends;
    for (int action = 0; action < Model::action_count(); ++action, --steps) {
      if (const End end = end_by(start, action, random); end.action >= 0) ends.push_back(end);
    }
    sort_stably(ends, [](const End& one, const End& other) { return one.earned > other.earned; });
    List<int> exits;
    for (std::size_t i = 0; i < std::min(most_exits, ends.size()); ++i) exits.push_back(ends[i].action);
    return exits;
  }

  // Takes the action after which an end earns more than the one at hand does, and most. Returns it; -1 if there is none.
  static int put_off(State& state, const End& end, const List<int>& exits, double& steps, Sampler& random) {
    double most = end.earned;
    int chosen = -1;
    State after = state;
    for (int action = 0; action < Model::action_count(); ++action, --steps) {
      State next = state;
      const double reward = Model::step(next, action, random).reward;
      if (Model::ending(next) != Ending::running) continue;
      const End later = best_end(next, exits, steps, random);
      if (later.action < 0 || reward + Model::discount * later.earned <= most) continue;
      most = reward + Model::discount * later.earned;
      chosen = action;
      after = std::move(next);
    }
    if (chosen >= 0) state = std::move(after);
    return chosen;
  }

  // The end at once that earns most, if any of the exits ends the mission.
  static End best_end(const State& state, const List<int>& exits, double& steps, Sampler& random) {
    End best;
    for (const int action : exits) {
      const End end = end_by(state, action, random);
      --steps;
      if (end.action >= 0 && (best.action < 0 || end.earned > best.earned)) best = end;
    }
    return best;
  }
  static End end_by(State state, int action, Sampler& random) {
    const double earned = Model::step(state, action, random).reward;
    const Ending ending = Model::ending(state);
    return ending == Ending::running || ending == Ending::failure ? End{} : End{action, earned};
  }

  const DecisionClock& clock_;
  const RunningDown<Model>* retries_;
};

}
