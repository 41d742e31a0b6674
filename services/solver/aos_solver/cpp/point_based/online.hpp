// SARSOP during a mission. The search continues from the belief of each decision and keeps what it has found out.
//
// Its implementation is an object file of its own, which is compiled once for all models.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>

#include "aos/base/function_ref.hpp"
#include "point_based/flat_model.hpp"

namespace aos::point_based {

using Asked = FunctionRef<bool()>;      // now and then: whether the work is to end
// Ends of missions: no further one begins once they are over, and the one that is played breaks off where it is late.
struct Ends {
  Asked over;
  Asked late;
};
using Uniform = FunctionRef<double()>;  // draws a number in [0, 1)

// The bounds of an action's value, how many trials began with it, and how probable it is at most that more can be earned after it.
struct ActionBounds {
  double lower = 0;
  double upper = 0;
  std::uint32_t trials = 0;
  double goes_on = 1;
};

// What the decisions of a mission lose of a lower bound, and the part of it that those lose which are not proven to be the best,
// such as ties. They gain where it is negative. Without a horizon, `later` is what the bound counts beyond the decisions. `played`
// is the share of what the bound promises that had been earned when the mission ended or broke off.
struct MissionLoss {
  double all = 0;
  double unsettled = 0;
  double later = 0;
  double played = 1;
};

// What a policy returns that needs no search (base_policies.hpp): its first action, its mean return, the part of that which
// it earns within the steps that were played, and the standard error of the mean.
struct PolicyValue {
  std::uint32_t action = 0;
  double value = 0;
  double within = 0;
  double standard_error = 0;
};

// Thrown for a lower bound above an upper one: the cause is a mistake in this folder, whatever the model.
struct CrossedBounds : std::logic_error {
  using std::logic_error::logic_error;
};

class OnlineSarsop {
 public:
  using IsOver = std::function<bool()>;
  struct Limit {
    std::uint64_t work;  // 0: no limit
    const IsOver& is_over;
  };

  // Computes the initial bounds. Without a horizon the discount must be below 1. Throws std::length_error if
  // there are too many states for the horizon.
  explicit OnlineSarsop(FlatModel model);
  ~OnlineSarsop();

  // Forgets what trials have found out and keeps the initial bounds.
  void start_over();

  // Continues from a belief, by state, with the whole horizon left, or with fewer decisions. The probabilities may sum to less
  // than 1, and the missing part is worth nothing. Returns whether the model's starts can lead to this belief, and whether the search
  // can tell as many decisions apart.
  bool move_to(const List<std::pair<std::uint32_t, double>>& belief, std::size_t left);
  bool move_to(const List<std::pair<std::uint32_t, double>>& belief);

  // Runs trials until `is_over()`, until `max_work` is done (0: no limit), or until nothing is left to find out. The last trial
  // may be cut short, and `is_late()` cuts what it has found, too. Returns the work in operations (belief_graph.hpp).
  std::uint64_t improve(std::uint64_t max_work, const IsOver& is_over, const IsOver& is_late);
  std::uint64_t improve(std::uint64_t max_work, const IsOver& is_over) { return improve(max_work, is_over, is_over); }
  // Runs trials below an action that is being carried out, without a limit of the work. Returns the work.
  std::uint64_t improve_below(std::uint32_t action, const IsOver& is_over);

  // What `steps` decisions of missions earn less than the lower bound, which begin with an action and decide anew with the
  // whole horizon at each step; at most 30 missions. The last one may exceed the work a little. With a
  // horizon there are none before the bounds of the belief have nearly met. Adds the work to `work`.
  List<MissionLoss> losses(std::uint32_t action, std::size_t steps, std::uint64_t max_work, const IsOver& is_over,
                                  std::uint64_t& work);

  // The best of some simple policies from the belief, by missions of `steps` decisions; none where the bounds have nearly met,
  // where no mission fits the work, and where it does not return more than the lower bound by a standard error. The one that was
  // found last needs no standard error. Where it `decides_anew`, each decision has the whole horizon to go, and bounds do not matter.
  // Adds the work to `work`. Of the first policy the fewest missions that tell a mean may take the `most`, all else the `usual` limit.
  std::optional<PolicyValue> best_policy(std::size_t steps, const Limit& usual, const Limit& most, std::uint64_t& work, bool decides_anew = false);
  std::optional<PolicyValue> best_policy(std::size_t steps, const Limit& limit, std::uint64_t& work, bool decides_anew = false) {
    return best_policy(steps, limit, limit, work, decides_anew);
  }

  // Looks one step ahead of each action of the belief moved to, unless `is_late()` comes first. It makes their bounds narrower.
  void open_actions(const IsOver& is_late);
  // The bounds of all actions at the belief moved to: discounted, over the whole horizon. These bounds and
  // those of `bounds` hold in spite of rounding.
  List<ActionBounds> action_bounds();
  // The bounds of the value of the belief moved to. Throws CrossedBounds.
  std::pair<double, double> bounds();
  // Some policy never returns less than the first number, which is at most 0, and no state is worth more than the second,
  // which is at least 0. Without a horizon these hold for all that is to come.
  std::pair<double, double> extremes() const;

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}
