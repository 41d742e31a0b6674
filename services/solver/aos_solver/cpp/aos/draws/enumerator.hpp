// Runs model code once for each combination of its discrete draws, with the combination's probability.
#pragma once

#include <optional>

#include "aos/base/function_ref.hpp"
#include "aos/draws/directed.hpp"
#include "aos/draws/loop_chain.hpp"
#include "aos/draws/loop_heads.hpp"
#include "aos/draws/number_strata.hpp"

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
// A loop that draws until a condition holds has paths without end. Model code tells of its loops. A path is cut at the
// head of a loop, and what follows is walked once from each head that differs from the others. A path that has come to
// an end after a head stands for all that lead there: its probability is that of getting there times the number of
// times that a run comes to the head (see loop_chain.hpp), which is known once all heads are walked. So ends after
// heads are walked again then.
//
// A head from which no path comes to an end is an end itself: model code is left there by an EndlessPath.
//
// A loop whose heads all differ, such as one that counts its rounds, has heads without end. The likeliest are walked
// first, until the others are negligible. If there are too many heads, as in a loop that fills an array, paths are not
// cut. They are then walked depth first, and a new draw takes its first outcome first. A path that gets long makes its
// new draws at random; their seed is fixed, and a walk always comes out the same. The rest is then walked best first,
// too. So are the paths of a loop that the code does not tell of.
class Enumerator final : public DirectedDraws, private LoopHeads {
 public:
  // The probability of the path, times the weight that the sink gives the numbers that it reports.
  double probability() const { return visits_ * probability_ * weight_of_numbers(); }

  // How many choices are known of the path. Before a run, these are the choices shared with the path before.
  std::size_t draws() const { return given_.size() + choices_.size(); }

  int choose(const double* weights, int count, double total) override;
  double uniform() override;
  LoopHeads* loop_heads() override { return is_world_ ? nullptr : this; }
  void end_world() override { is_world_ = false; }

  // From now on chance makes the continuous draws, the same ones in all runs. What is walked are then the combinations
  // of the discrete draws under this luck.
  void leave_numbers_to(std::uint64_t luck) { luck_ = luck; }
  // From now on chance makes all draws of the extrinsic changes, the same ones in all runs, or no longer where none is given.
  // What is walked are then the combinations of the skill's draws in one world.
  void leave_world_to(std::optional<std::uint64_t> luck) { world_ = luck; }
  // From now on a continuous draw gives the middle of one of these strata. What is walked are then estimates.
  void divide_numbers(DrawStrata strata) { strata_ = strata; }
  // Whether a continuous draw has been asked for so far, and whether one was made in this run.
  bool meets_number() const { return meets_number_; }
  bool has_drawn_number() const { return has_drawn_number_; }

  using Run = FunctionRef<void(Enumerator&)>;

  // Calls `run(enumerator)` for each path, and `visit(enumerator)` once its end has been reached; `probability()` is
  // the path's then. `run` may run model code and keep its result. Some runs are cut short or are not visited. Throws
  // NotEnumerable.
  void for_each_path(Run run, Run visit, int max_paths = path_budget) {
    walk(run, visit, max_paths, std::numeric_limits<std::size_t>::max());
  }

  // Does the same, but leaves out negligible paths of loops without end. Returns the probability of the paths that were
  // not walked, which is at most `max_left_out`. Throws NotEnumerable.
  double for_nearly_each_path(Run run, Run visit, int max_paths = path_budget) {
    return walk(run, visit, max_paths, max_draws_depth_first);
  }

 private:
  static constexpr int none = -1;
  static constexpr std::uint32_t no_node = 0xffffffffu;
  static constexpr std::size_t on_the_way = std::numeric_limits<std::size_t>::max();  // a depth before `from_`

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

  std::uint32_t enter() override;
  std::string* arrive(std::uint32_t loop, std::uint32_t entry) override;
  [[noreturn]] void cut() override;

  void start_from(LoopChain::Number head);
  // Goes to the next path, depth first. Returns false after the last one.
  bool advance();

  using End = FunctionRef<void()>;

  double walk(Run run, Run visit, int max_paths, std::size_t max_depth_first);
  double walk_without_cuts(Run run, Run visit, int max_paths, std::size_t max_depth_first);
  // Lists what follows each head. Returns the probability of what is not listed.
  double list_heads(Run run, std::size_t max_depth_first);
  // Walks the paths from the head on, up to their ends or other heads. Returns the probability of those not walked.
  double walk_on(Run run, End at_end, std::size_t max_depth_first);

  [[noreturn]] void give_up() const;
  void begin_run_with_loops();
  int choose_given();
  // Throws an EndlessPath, or NotEnumerable where other numbers might lead to an end.
  [[noreturn]] void leave_endless(std::uint32_t loop) const;
  void run_once(Run run, End at_end);

  double best_first(Run run, End at_end);
  // Stores the paths that branch off the one just walked.
  void put_off();
  void take_likeliest();

  std::optional<std::uint64_t> luck_;  // of the continuous draws
  std::optional<std::uint64_t> world_;  // its luck
  bool is_world_ = false;  // what draws now, and leaves it to luck
  Sampler of_world_{0};
  DrawStrata strata_;
  bool meets_number_ = false;
  bool has_drawn_number_ = false;
  Sampler drawn_{0};
  List<Choice> choices_;  // since the head that is walked from
  std::size_t depth_ = 0;
  double probability_ = 1;  // of these
  int paths_left_ = 0;

  // The way to that head.
  List<int> given_;
  std::size_t given_left_ = 0;
  List<LoopChain::Stop> stops_;
  LoopChain::Number from_ = LoopChain::start;
  double visits_ = 1;

  // The last head that the run has passed.
  LoopChain::Number at_ = LoopChain::start;
  std::size_t next_stop_ = 0;
  std::size_t draws_at_ = 0;
  std::uint64_t events_ = 0;  // how often the run has entered loops and come to heads
  std::uint64_t events_at_ = 0;

  LoopChain chain_;
  bool has_loops_ = false;
  bool is_listing_ = false;
  bool is_cutting_ = false;
  bool has_arrived_ = false;  // at a head where paths are cut
  bool has_number_since_ = false;    // a continuous draw since the last head of the run
  bool has_number_between_ = false;  // one between two heads, so that luck may lead a loop to its end
  std::string way_;
  std::string key_;

  bool is_best_first_ = false;
  Sampler chance_{0};
  List<Node> nodes_;
  List<Begun> begun_;      // a heap, the likeliest on top
  std::size_t shared_ = 0;        // the choices of this path that have nodes, up to `last_`
  std::uint32_t last_ = no_node;
  double waiting_ = 0;
  double dropped_ = 0;
};

// The work of a step along a path, counted in draws beforehand. Copying a large state costs as much as some draws.
inline std::size_t work_of_step(const auto& path, std::size_t state_bytes) {
  constexpr std::size_t bytes_per_draw = 64;
  return 1 + path.draws() + state_bytes / bytes_per_draw;
}

}
