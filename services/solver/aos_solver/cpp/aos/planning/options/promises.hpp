// What decisions of a mission have promised, and what came of it.
//
// A decision tells a value. If values are right, the value of a decision is the reward of its action and the discounted value of
// the next decision, on average. A robot that probes for ever, since the next probe is always worth it, loses a little at each step, and the
// losses agree. Luck is now large and now small, and does not. So what was lost counts as far as it is more than luck explains: more than
// the root of the sum of squares, which is the standard deviation of a sum of independent surprises.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace aos {

class Promises {
 public:
  // The next decision is not one that follows the last one.
  void forget() {
    told_.reset();
    due_.reset();
  }

  // A decision tells this value of an action with this mean reward.
  void tell(int action, double value, double reward, double discount) { told_ = {action, (value - reward) / discount}; }
  void note_taken(int action) {
    due_ = told_ && told_->action == action ? std::optional{told_->later} : std::nullopt;
    told_.reset();
  }
  // The next decision has found this value.
  void keep(double value) {
    if (!due_) return;
    const double lost = *due_ - value;
    due_.reset();
    sum_ += lost;
    squares_ += lost * lost;
  }

  // What was lost more than luck explains.
  double lost() const { return std::max(sum_ - std::sqrt(squares_), 0.0); }

 private:
  struct Told {
    int action;
    double later;  // the value of the next decision, if the promise is kept
  };

  std::optional<Told> told_;
  std::optional<double> due_;
  double sum_ = 0;
  double squares_ = 0;
};

}
