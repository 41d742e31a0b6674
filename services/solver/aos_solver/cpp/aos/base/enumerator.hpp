// Model code over the combinations of its discrete draws, each with its probability.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "aos/base/directed.hpp"
#include "aos/base/random.hpp"

namespace aos {

// A draw that has no finite set of outcomes, or more combinations than the budget: sampling has to do.
struct NotEnumerable {
  const char* reason;
};
inline constexpr const char* numbers_are_observed = "what is observed are numbers";

inline constexpr int path_budget = 4096;
inline constexpr std::size_t max_draws_of_path = 100'000;
// A path with more draws is taken to be in a loop that chance ends.
inline constexpr std::size_t max_draws_depth_first = 64;
inline constexpr std::size_t max_frontier = 4'000'000;  // of paths that are only begun, in nodes
inline constexpr double negligible_paths = 1e-9;        // in all: they need not be walked
inline constexpr double max_left_out = 1e-6;            // in all, where the budget is used up

// Replays model code. One run follows one path: known choices are repeated, new ones are made. Outcomes of probability
// zero are never walked.
//
// Paths are walked depth first, the first outcome of each new draw first. A loop that draws until a condition holds has
// paths without end, though, and depth first may follow the endless one. So when a path gets long, new draws are made at
// random from then on (with a seed of its own: a walk is always the same), and what is not walked yet is walked best
// first: its probable parts before the others, until what is left is negligible.
class Enumerator final : public DirectedDraws {
 public:
  // Of the path, with what its sink makes of the numbers that it reports.
  double probability() const { return probability_ * weight_of_numbers(); }

  // How many choices are known of the path: all of the one before it that it shares.
  std::size_t draws() const { return choices_.size(); }

  int choose(const double* weights, int count, double total) override;
  double uniform() override;

  // Calls `run(enumerator)` once for each path; after it, `probability()` is the path's. Throws NotEnumerable.
  template <class Run>
  void for_each_path(Run&& run, int max_paths = path_budget) {
    walk(run, max_paths, std::numeric_limits<std::size_t>::max());
  }

  // The same for models with loops that chance ends: returns what the paths weigh, together, that were not walked, which
  // is little. Throws NotEnumerable, too.
  template <class Run>
  double for_nearly_each_path(Run&& run, int max_paths = path_budget) {
    return walk(run, max_paths, max_draws_depth_first);
  }

 private:
  static constexpr int none = -1;
  static constexpr std::uint32_t no_node = 0xffffffffu;

  // The outcomes of a draw are walked in their order, from the first one that was taken around to it.
  struct Choice {
    int taken;
    int following;  // or `none`
    int first;
    double following_weight;  // of all that follow, with the path to here; known best first only
  };
  // A choice as the end of the path to it.
  struct Node {
    std::uint32_t before;
    int taken;
    int first;
  };
  // Paths that agree up to a node, and go on with what has not been walked there.
  struct Begun {
    double weight;
    std::uint32_t before;
    int taken;
    int first;
  };

  // Numbers are not enumerated, so there must be a sink that has another use for them.
  void ignore_number() override { throw NotEnumerable{numbers_are_observed}; }

  void start();
  // To the next path, depth first; false after the last.
  bool advance();

  // Returns what the paths weigh that were not walked.
  template <class Run>
  double walk(Run& run, int max_paths, std::size_t max_depth_first) {
    start();
    int paths = 0;
    do {
      if (++paths > max_paths) throw NotEnumerable{"there are more combinations of draws than can be walked"};
      run_once(run);
      if (depth_ > max_depth_first) return best_first(run, max_paths - paths);
    } while (advance());
    return 0;
  }

  template <class Run>
  void run_once(Run& run) {
    depth_ = 0;
    probability_ = 1;
    begin_numbers();
    run(*this);
  }

  template <class Run>
  double best_first(Run& run, int max_paths) {
    if (!advance()) return 0;
    begin_best_first();
    for (int paths = 0; paths < max_paths && nodes_.size() < max_frontier; ++paths) {
      run_once(run);
      put_off();
      if (begun_.empty() || waiting_ + dropped_ <= negligible_paths) return waiting_ + dropped_;
      take_likeliest();
    }
    if (waiting_ + dropped_ > max_left_out) throw NotEnumerable{"loops that draw have more paths than can be walked"};
    return waiting_ + dropped_;
  }
  void begin_best_first();
  // Notes what the path that was just walked leaves for later.
  void put_off();
  void take_likeliest();

  std::vector<Choice> choices_;
  std::size_t depth_ = 0;
  double probability_ = 1;

  bool is_best_first_ = false;
  Sampler chance_{0};
  std::vector<Node> nodes_;
  std::vector<Begun> begun_;      // a heap, the likeliest on top
  std::size_t shared_ = 0;        // choices of this path that the nodes up to `last_` stand for
  std::uint32_t last_ = no_node;
  double waiting_ = 0;
  double dropped_ = 0;
};

// Before a step along a path: what it takes, in draws. A large state costs as much to copy.
inline std::size_t work_of_step(const Enumerator& path, std::size_t state_bytes) {
  constexpr std::size_t bytes_per_draw = 64;
  return 1 + path.draws() + state_bytes / bytes_per_draw;
}

}  // namespace aos
