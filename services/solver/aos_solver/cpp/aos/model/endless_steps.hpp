// Steps of models with loops that draw, which may have no end in some states.
//
// A loop that looks for a free place never ends where no place is free. A path of a step that comes to such a loop ends the
// mission there, as a failure: the state is the one before the step, nothing is observed, and the reward is the penalty
// where the precondition is violated. An enumerator finds these paths exactly. Any other source of draws goes on until a loop
// has taken `long_loop` rounds, and an enumerator then says whether a step from that state may have no end.
#pragma once

#include <map>
#include <mutex>
#include <unordered_set>

#include "aos/base/mixed.hpp"
#include "aos/base/set_for_now.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/loop_heads.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/build_kind.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/step.hpp"

namespace aos {

inline constexpr std::uint32_t long_loop = 512;  // rounds
inline constexpr int paths_of_long_loop = 512;    // that are walked to see whether it ends
inline constexpr std::size_t max_known_endless = 10'000;  // states of a skill and a thread
inline constexpr std::uint64_t lucks_of_long_loop = 8;  // of the continuous draws, with which they are walked

// The steps of this process that did not come to an end, by their loops.
class EndlessSteps {
 public:
  struct Told {
    std::uint64_t steps = 0;
    std::string state;  // before the first of them
  };
  void add(std::uint32_t loop, AnyValue before);
  // Calls `tell` with the number of each loop and what is told of it.
  void for_each(auto&& tell) const {
    const std::lock_guard guard{mutex_};
    for (const auto& [loop, told] : loops_) tell(loop, told);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint32_t, Told> loops_;
};
EndlessSteps& endless_steps();

namespace detail {

// How many rounds a loop may take in this thread before somebody looks whether it has an end. Each look that finds an end
// makes it more.
std::uint32_t& rounds_before_a_look(std::uint32_t loop);

}  // namespace detail

// Runs the phases of a step, which may have no end.
struct LoopingSteps {
  template <class State>
  static Step run(State& next, const auto& parameters, auto& random, double penalty, auto&& phases) {
    const State before = next;
    bool meets_precondition = true;
    try {
      const SetForNow rounds{allowed_rounds, long_loop};
      return phases(next, random, meets_precondition);
    } catch (const EndlessPath& endless) {
      return end(next, before, endless.loop, meets_precondition ? 0 : penalty);
    } catch (const LongLoop& found) {
      if (is_known_endless(before, found.loop, &parameters, phases)) {
        return end(next, before, found.loop, meets_precondition ? 0 : penalty);
      }
    }
    next = before;
    meets_precondition = true;
    const SetForNow rounds{allowed_rounds, any_rounds};
    return phases(next, random, meets_precondition);
  }

 private:
  template <class State>
  static Step end(State& next, const State& before, std::uint32_t loop, double reward) {
    blame::over();
    endless_steps().add(loop, before);
    next = before;
    next.aos_ending = Ending::failure;
    return {reward, no_observation};
  }

  // The same as below. What has been found is kept for each skill, with a place for each grounded action's parameters.
  template <class State>
  static bool is_known_endless(const State& before, std::uint32_t loop, const void* parameters, auto&& phases) {
    thread_local std::unordered_set<std::uint64_t> known;
    const std::uint64_t key = mixed(mixed(hashed(0, before), loop), reinterpret_cast<std::uintptr_t>(parameters));
    if (known.contains(key)) return true;
    if (!has_endless_path(before, loop, phases)) return false;
    if (known.size() == max_known_endless) known.clear();
    known.insert(key);
    return true;
  }

  // Whether some draws lead a step from this state into a loop without an end.
  template <class State>
  static bool has_endless_path(const State& before, std::uint32_t loop, auto&& phases) {
    blame::over();
    bool has = false;
    bool is_endless = false;
    std::uint32_t& rounds = detail::rounds_before_a_look(loop);
    const auto run = [&](Enumerator& path) {
      ModelSource<DirectedDraws> draws{path};
      State state = before;
      bool meets_precondition = true;
      is_endless = false;
      try {
        phases(state, draws, meets_precondition);
      } catch (const EndlessPath&) {
        is_endless = true;
      }
    };
    try {
      for (std::uint64_t luck = 1; luck <= lucks_of_long_loop && !has; ++luck) {
        Enumerator paths;
        paths.report_to(&ignored_numbers);
        paths.leave_numbers_to(luck);
        paths.for_nearly_each_path(run, [&](Enumerator&) { has = has || is_endless; }, paths_of_long_loop);
      }
      if (!has) rounds *= 16;
    } catch (const NotEnumerable&) {
      rounds = any_rounds;
    } catch (const TooManyHeads&) {
      rounds = any_rounds;
    }
    blame::over();
    return has;
  }
};

}  // namespace aos
