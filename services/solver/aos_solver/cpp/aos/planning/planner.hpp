// What all planners have in common: how they are asked for a decision, and what they tell of it.
//
// A planner gets ready for a decision, or says why it cannot make it. Then it searches, and its estimates decide.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/function_ref.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/listed/state_space.hpp"

namespace aos {

// A decision that is asked for. The `barred` actions cannot be taken now.
template <class Model>
struct Question {
  const Belief<Model>& belief;
  Budget budget;
  int horizon;
  const BarredActions& barred;
  bool is_by_name = false;  // whether this planner was asked for
  bool is_listed = false;   // whether the states that the belief can lead to are listed
};

// What is told of the choice of a planner: why it decides, and what was spent on it that is not preparation, in processor time of
// this thread and by the clock of budgets.
struct Choosing {
  std::string why;
  std::chrono::nanoseconds searching{};
  std::chrono::nanoseconds spent{};
  std::uint64_t simulations = 0;
};

// Counts what is done in its scope as search, and not as preparation.
class SearchTime {
 public:
  explicit SearchTime(Choosing& choosing) : choosing_(choosing) {}
  ~SearchTime() {
    choosing_.searching += thread_time() - thread_start_;
    choosing_.spent += PlanningClock::now() - start_;
  }
  SearchTime(const SearchTime&) = delete;
  SearchTime& operator=(const SearchTime&) = delete;

 private:
  Choosing& choosing_;
  std::chrono::nanoseconds thread_start_ = thread_time();
  PlanningClock::time_point start_ = PlanningClock::now();
};

template <class Model>
class Planner {
 public:
  explicit Planner(const StateSpace<Model>& space) : space_(space) {}
  virtual ~Planner() = default;
  Planner(const Planner&) = delete;  // planners refer to one another
  Planner& operator=(const Planner&) = delete;

  virtual const char* name() const = 0;
  // Returns whether it can decide, and is ready then. `choosing.why` goes on with the reason, or with what keeps it from that.
  virtual bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) = 0;
  // The planner that searches after `prepare`: this one, or another that it has compared itself with and made ready.
  virtual Planner& decider() { return *this; }
  // Searches for the decision of `prepare`. Returns how many simulations it took, as budget.hpp counts them.
  virtual std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) = 0;

  // What the search has found of the actions, by which `choice` decides. Values are over the whole belief, whose ended part
  // counts as 0.
  virtual Estimates estimates(const Belief<Model>& belief) const = 0;
  // The action to take: the one with the highest estimate among those with reliable values.
  virtual int choice(const Estimates& estimates, int horizon, const BarredActions& barred) const {
    const auto is_barred = [&](const ActionEstimate& estimate) {
      return barred.contains(&estimate - estimates.data());
    };
    ActionEstimate most;  // the most visited one
    for (const ActionEstimate& estimate : estimates) {
      if (!is_barred(estimate) && estimate.n > most.n) most = estimate;
    }
    return preferred_action(estimates, horizon, [&](const ActionEstimate& estimate) {
      return !is_barred(estimate) && estimate.n > 0 && is_reliable(estimate, most);
    });
  }
  // Whether it may promise more after an action that changes nothing and tells nothing than it promises now.
  virtual bool may_put_off() const { return false; }
  // What a decision tells if the belief is what it should be; `estimates` are those by which `choice` was made.
  virtual Estimates values(const Belief<Model>& /*belief*/, Estimates estimates, int /*choice*/) const { return estimates; }
  // How far bounds of values have to be widened; see StateSpace.
  virtual double slack(const Belief<Model>& belief, int horizon) const { return space_.slack(belief, horizon); }

  // Searches below an action that is being carried out, until `is_over()`, which is called every millisecond or so.
  virtual void ponder(int /*action*/, const Question<Model>& /*question*/, Sampler& /*random*/, FunctionRef<bool()> /*is_over*/) {}
  // Keeps what serves the decision after an action and an observation.
  virtual void advance(int /*action*/, Observation /*observation*/) {}
  // Drops what holds for the last belief only.
  virtual void forget() {}
  // Begins another mission, which does not depend on those before it.
  virtual void start_over() { forget(); }
  // How many simulations of earlier searches serve the next one.
  virtual std::uint64_t known_simulations() const { return 0; }
  // The simulations of each thread of the last search; empty where there is one thread.
  virtual List<std::uint64_t> simulations_by_thread() const { return {}; }

 protected:
  // Whether an estimate is good enough for a decision, beside that of the most visited action.
  virtual bool is_reliable(const ActionEstimate& /*estimate*/, const ActionEstimate& /*most*/) const { return true; }

 private:
  const StateSpace<Model>& space_;
};

}
