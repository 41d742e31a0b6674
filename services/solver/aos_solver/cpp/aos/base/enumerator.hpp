// Model code over every combination of its discrete draws, each with its probability.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"

namespace aos {

// A draw that has no finite set of outcomes, or more combinations than the budget: sampling has to do.
struct NotEnumerable {
  const char* reason;
};
inline constexpr const char* numbers_are_observed = "what is observed are numbers";

inline constexpr int path_budget = 4096;

// Replays model code. One run follows one path: known choices are repeated, new ones take their first outcome. Outcomes
// of probability zero are never walked.
//
// Where a step has too many paths, or a continuous draw, the first draws of a path can be left to chance, and the last
// ones, which usually decide what is observed, enumerated.
class Enumerator : public Draws<Enumerator> {
 public:
  // Of the path; given the draws that were left to chance. With what its sink makes of the numbers that it reports.
  double probability() const { return sink_ == nullptr ? probability_ : probability_ * sink_->weight(); }

  // How many choices are known of the path: all of the one before it that it shares.
  std::size_t draws() const { return choices_.size(); }

  bool flag(double probability) {
    if (probability <= 0) return false;
    if (probability >= 1) return true;
    const double weights[] = {1 - probability, probability};
    return choose(weights, 2, 1.0) == 1;
  }

  int choose(const double* weights, int count, double total);
  double uniform();
  // Numbers are not enumerated: without a sink that has another use for them this throws NotEnumerable.
  void report(std::uint32_t key, const Distribution& distribution);
  // Returns the sink before.
  NumberSink* report_to(NumberSink* sink) { return std::exchange(sink_, sink); }

  // Calls `run(enumerator)` once for each path; after it, `probability()` is the path's. Throws NotEnumerable.
  template <class Run>
  void for_each_path(Run&& run, int most = path_budget) {
    start(nullptr, 0);
    int paths = 0;
    do {
      if (++paths > most) throw NotEnumerable{"there are more combinations of draws than can be walked"};
      run_once(run);
    } while (advance());
  }

  // One path at random, of probability 1.
  template <class Run>
  void draw_path(Sampler& chance, Run&& run) {
    start(&chance, all_draws);
    run_once(run);
  }

  // How many paths there were if all had as many alternatives as the one that was just drawn; on average this is right
  // (Knuth, 1975). Infinite where a draw is continuous.
  double combinations() const;

  // How many draws of the path that was just drawn come before those that have at most `most` combinations together.
  std::size_t draws_before_last(int most) const;

  // Calls `run(enumerator)` once for each path that agrees with `by_chance` first draws, which are left to chance. Gives
  // up after `most` paths, and then returns false.
  template <class Run>
  bool for_each_completion(Sampler& chance, std::size_t by_chance, int most, Run&& run) {
    start(&chance, by_chance);
    int paths = 0;
    do {
      if (++paths > most) return false;
      run_once(run);
    } while (advance());
    return true;
  }

  // One path at random that agrees with the last one in its `by_chance` first draws.
  template <class Run>
  void redraw_after(std::size_t by_chance, Run&& run) {
    keep(by_chance);
    run_once(run);
  }

 private:
  static constexpr int none = -1;
  static constexpr int no_alternatives = 0;
  static constexpr std::size_t all_draws = static_cast<std::size_t>(-1);

  struct Choice {
    int taken;
    int following;
    int alternatives;  // of a draw left to chance: itself and the others that can happen
    double value = 0;  // of a continuous draw
  };

  int choose_by_chance(const double* weights, int count, double total);
  void start(Sampler* chance, std::size_t by_chance);
  // Of the last path so many choices; what follows is left to chance.
  void keep(std::size_t choices);
  bool advance();

  template <class Run>
  void run_once(Run& run) {
    depth_ = 0;
    probability_ = 1;
    if (sink_ != nullptr) sink_->begin();
    run(*this);
  }

  std::vector<Choice> choices_;
  std::size_t depth_ = 0;
  double probability_ = 1;
  Sampler* chance_ = nullptr;
  std::size_t by_chance_ = 0;
  NumberSink* sink_ = nullptr;
};

// Before a step along a path: what it takes, in draws. A large state costs as much to copy.
inline std::size_t work_of_step(const Enumerator& path, std::size_t state_bytes) {
  constexpr std::size_t bytes_per_draw = 64;
  return 1 + path.draws() + state_bytes / bytes_per_draw;
}

}  // namespace aos
