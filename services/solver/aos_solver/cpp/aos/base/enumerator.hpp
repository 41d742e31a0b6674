// Runs model code once for each combination of its discrete draws, with the combination's probability.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "aos/base/directed.hpp"
#include "aos/base/random.hpp"

namespace aos {

// Thrown for a continuous draw, and for more combinations than the budget. The caller then samples.
struct NotEnumerable {
  const char* reason;
};
inline constexpr const char* numbers_are_observed = "what is observed are numbers";

inline constexpr int path_budget = 4096;
inline constexpr std::size_t max_draws_of_path = 100'000;
// A path with more draws than this counts as a loop that chance ends.
inline constexpr std::size_t max_draws_depth_first = 64;
inline constexpr std::size_t max_frontier = 4'000'000;  // of nodes, in a best-first walk
inline constexpr double negligible_paths = 1e-9;        // the total probability of paths that may be left out
inline constexpr double max_left_out = 1e-6;            // the same once the budget is used up

// Replays model code, one path of draws in each run. A run repeats the choices that are known of its path,
// and makes the later ones. Outcomes of probability zero are never walked.
//
// Paths are walked depth first, and a new draw takes its first outcome first. A loop that draws until a
// condition holds has paths without end, and a depth-first walk may follow the endless one. So a path that
// gets long makes its new draws at random; their seed is fixed, and a walk always comes out the same. The
// rest is then walked best first: the most probable paths come first, until the others are negligible.
class Enumerator final : public DirectedDraws {
 public:
  // The probability of the path, times the weight that the sink gives the numbers that it reports.
  double probability() const { return probability_ * weight_of_numbers(); }

  // How many choices are known of the path. Before a run, these are the choices shared with the path before.
  std::size_t draws() const { return choices_.size(); }

  int choose(const double* weights, int count, double total) override;
  double uniform() override;

  // Calls `run(enumerator)` for each path; `probability()` is the path's afterwards. Throws NotEnumerable.
  template <class Run>
  void for_each_path(Run&& run, int max_paths = path_budget) {
    walk(run, max_paths, std::numeric_limits<std::size_t>::max());
  }

  // Does the same for models with loops that chance ends. Returns the probability of the paths that were not
  // walked, which is at most `max_left_out`. Throws NotEnumerable.
  template <class Run>
  double for_nearly_each_path(Run&& run, int max_paths = path_budget) {
    return walk(run, max_paths, max_draws_depth_first);
  }

 private:
  static constexpr int none = -1;
  static constexpr std::uint32_t no_node = 0xffffffffu;

  // A choice of a path. The outcomes of its draw are walked in their order, from `first` on and around to it.
  struct Choice {
    int taken;
    int following;  // the outcome to walk next, or `none`
    int first;
    double following_weight;  // probability of the path with a later outcome; set best first only
  };
  // The last choice of a path; `before` is the node of the choice before.
  struct Node {
    std::uint32_t before;
    int taken;
    int first;
  };
  // The paths that agree up to node `before` and have not been walked from outcome `taken` on.
  struct Begun {
    double weight;
    std::uint32_t before;
    int taken;
    int first;
  };

  // A number cannot be enumerated, so a sink has to take it.
  void ignore_number() override { throw NotEnumerable{numbers_are_observed}; }

  void start();
  // Goes to the next path, depth first. Returns false after the last one.
  bool advance();

  // Returns the probability of the paths that were not walked.
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
  // Stores the paths that branch off the one just walked.
  void put_off();
  void take_likeliest();

  std::vector<Choice> choices_;
  std::size_t depth_ = 0;
  double probability_ = 1;

  bool is_best_first_ = false;
  Sampler chance_{0};
  std::vector<Node> nodes_;
  std::vector<Begun> begun_;      // a heap, the likeliest on top
  std::size_t shared_ = 0;        // the choices of this path that have nodes, up to `last_`
  std::uint32_t last_ = no_node;
  double waiting_ = 0;
  double dropped_ = 0;
};

// The work of a step along a path, counted in draws beforehand. Copying a large state costs as much as some draws.
inline std::size_t work_of_step(const Enumerator& path, std::size_t state_bytes) {
  constexpr std::size_t bytes_per_draw = 64;
  return 1 + path.draws() + state_bytes / bytes_per_draw;
}

}  // namespace aos
