// What the actions can lead to at all: every outcome of every action, breadth first, whatever its probability.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <unordered_set>
#include <vector>

#include "aos/belief/belief.hpp"
#include "aos/model/blame.hpp"

namespace aos {

inline constexpr std::size_t most_reached_states = 100'000;
inline constexpr std::size_t most_reached_bytes = std::size_t{256} << 20;

// Ends early when a goal is found and every precondition is met somewhere.
template <class Model>
class Reachability {
 public:
  using State = typename Model::State;
  using Clock = std::chrono::steady_clock;

  Reachability(const Belief<Model>& belief, double seconds)
      : latest_(Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>{seconds})),
        unmet_(static_cast<std::size_t>(Model::action_count())),
        is_met_(unmet_, false) {
    try {
      if (!belief.is_exact()) throw NotEnumerable{"the initial belief is only known by samples"};
      for (const auto& particle : belief.particles()) add(particle.state);
      walk();
    } catch (const NotEnumerable& limit) {
      blame::at(0);
      limit_ = limit.reason;
    }
  }

  bool has_goal() const { return has_goal_; }
  bool is_met(int action) const { return is_met_[static_cast<std::size_t>(action)]; }
  std::size_t states() const { return known_.size(); }
  int depth() const { return depth_; }
  // Why there may be more; empty where all was looked at.
  const char* limit() const { return limit_; }

 private:
  struct Hash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };

  void walk() {
    std::size_t level_end = waiting_.size();
    for (std::size_t next = 0; next < waiting_.size() && !(has_goal_ && unmet_ == 0); ++next) {
      if (next == level_end) {
        level_end = waiting_.size();
        ++depth_;
      }
      leave(*waiting_[next]);
    }
  }

  void leave(const State& state) {
    if (Model::ending(state) != Ending::running) return;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (Clock::now() > latest_) throw NotEnumerable{"it takes longer than allowed"};
      if (!is_met(action)) try_precondition(state, action);
      draws_.for_each_path([&](Enumerator& path) {
        State next = state;
        Model::step(next, action, path);
        add(next);
      });
    }
  }

  void try_precondition(const State& state, int action) {
    bool meets = false;
    draws_.for_each_path([&](Enumerator& path) { meets = Model::meets_precondition(state, action, path) || meets; });
    if (!meets) return;
    is_met_[static_cast<std::size_t>(action)] = true;
    --unmet_;
  }

  void add(const State& state) {
    const auto [entry, is_new] = known_.insert(state);
    if (!is_new) return;
    if (known_.size() > most_reached_states || known_.size() * sizeof(State) > most_reached_bytes) {
      throw NotEnumerable{"there are more states"};
    }
    waiting_.push_back(&*entry);
    has_goal_ = has_goal_ || Model::ending(state) == Ending::goal;
  }

  Clock::time_point latest_;
  std::size_t unmet_;
  std::vector<bool> is_met_;
  bool has_goal_ = false;
  int depth_ = 0;
  const char* limit_ = "";
  Enumerator draws_;
  std::unordered_set<State, Hash> known_;
  std::vector<const State*> waiting_;  // in the order of discovery; elements of `known_` stay where they are
};

}  // namespace aos
