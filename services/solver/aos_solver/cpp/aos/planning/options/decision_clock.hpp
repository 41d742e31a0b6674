// The clock that ends a decision with a budget in time, where steps of the model cost more in one part than in another.
#pragma once

#include <algorithm>
#include <limits>

#include "aos/base/clock.hpp"
#include "aos/base/set_for_now.hpp"

namespace aos {

class DecisionClock {
 public:
  // Lets what is done in its scope take so many seconds of those that are left.
  struct Slice : SetForNow<double> {
    Slice(DecisionClock& clock, double seconds) : SetForNow(clock.end_s_, std::min(clock.end_s_, clock.spent_s() + seconds)) {}
  };

  // Begins a decision of so many seconds; 0 are no limit.
  void begin(double seconds) {
    start_ = PlanningClock::now();
    seconds_ = seconds > 0 ? seconds : std::numeric_limits<double>::infinity();
    end_s_ = seconds_;
  }
  // The work that follows ends when this share of the decision's time has passed.
  void end_at(double share) { end_s_ = share * seconds_; }

  bool is_limited() const { return seconds_ < std::numeric_limits<double>::infinity(); }
  bool is_over() const { return is_limited() && left_s() <= 0; }
  double left_s() const { return end_s_ - spent_s(); }

 private:
  double spent_s() const { return seconds_since(start_); }

  PlanningClock::time_point start_{};
  double seconds_ = std::numeric_limits<double>::infinity();
  double end_s_ = seconds_;  // of the work at hand
};

}
