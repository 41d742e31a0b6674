// Scenarios: states with all their future randomness, and bounds of their values. The draws of a step depend
// on the scenario and the depth alone, so that actions are compared under equal luck. Where the outcomes of steps are
// listed, a step is a draw from the list, whatever the documents' code takes.
#pragma once

#include "aos/base/statistics.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/despot/despot_constants.hpp"
#include "aos/planning/same_observation.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/values/mdp_values.hpp"

namespace aos {

template <class Model>
struct Scenario {
  typename Model::State state;
  std::uint32_t number;
  std::uint32_t seen;  // the number of the state in the table of values, if there is one
};

// A scenario after a step, and the observation that the step gave.
template <class Model>
struct Observed {
  Scenario<Model> scenario;
  Observation observation;
};

// The bounds of a scenario's value, discounted from its depth on.
struct ScenarioBounds {
  double lower = 0;
  double upper = 0;
};

// Evaluates scenarios. A lower bound is what a default policy earns; no policy exceeds an upper bound.
//
// In a small model (mdp_values.hpp), returns are relative to the fully observable (MDP) value of a scenario's
// state. A step then earns the MDP value of its action less that of the best action in that state. On average
// over all luck, this adds up to the same return. Most of the luck is left out, and no policy exceeds 0.
//
// There are two default policies, and a history has the better of the two. One takes the action with the best
// mean MDP value over a group of scenarios, and the group splits by observations. Scenarios with rare
// observations stay together: a policy that followed so few scenarios would know what no robot can know. The
// other policy is that of the rollouts.
//
// Without MDP values, the highest return of a few rollouts replaces the upper bound, though it is no bound.
// If many scenarios have the same history, only some of them are evaluated.
template <class Model>
class ScenarioEvaluation {
 public:
  using State = typename Model::State;

  explicit ScenarioEvaluation(MdpValues<Model>& values) : values_(values) {}

  // Prepares MDP values if the model is small enough.
  void prepare(const Belief<Model>& belief, int horizon) {
    horizon_ = horizon;
    has_values_ = values_.prepare(belief, horizon);
    has_list_ = has_values_ && values_.space().lists_observations();
    if (has_values_ && code_cost_ == 0) code_cost_ = cost_of_step<Model>();
  }
  bool has_values() const { return has_values_; }
  std::uint32_t seen(const State& state) const { return has_values_ ? values_.number_of(state) : 0; }

  // Steps a scenario and counts the work. `has_ended` tells whether the mission is over then.
  Step step(Scenario<Model>& scenario, int action, int depth, bool& has_ended) {
    Sampler luck = draws(scenario.number, depth);
    if (has_list_ && scenario.seen != no_state) return listed_step(scenario, action, luck, has_ended);
    work_ += step_cost();
    const Step step = Model::step(scenario.state, action, luck);
    has_ended = Model::ending(scenario.state) != Ending::running;
    if (has_values_ && !has_ended) {
      const std::uint32_t next = values_.certain_next(scenario.seen, action);
      scenario.seen = next != no_state ? next : values_.number_of(scenario.state);
      work_ += next != no_state ? cost_of_certain : cost_of_number;
    }
    return step;
  }

  // The value that returns are relative to: the state's MDP value, or 0 without MDP values.
  double origin(std::uint32_t seen) const { return has_values_ ? values_.value(seen, horizon_) : 0; }
  // The reward of a step, relative to these values.
  double earned(std::uint32_t seen_before, int action, int depth, double reward) const {
    return has_values_ ? values_.advantage(seen_before, action, horizon_ - depth) : reward;
  }

  // Begins a decision with new luck for all scenarios.
  void start(std::uint64_t seed) {
    seed_ = seed;
    work_ = 0;
  }

  Sampler draws(std::uint32_t scenario, int depth) const {
    return Sampler{mixed(mixed(seed_, scenario), depth)};
  }

  // The bounds of each scenario. All have the same history but for the last observation, by which they are sorted.
  const List<ScenarioBounds>& bounds(const List<Observed<Model>>& scenarios, int depth) {
    bounds_.assign(scenarios.size(), {});
    earned_.assign(scenarios.size(), 0);
    followers_.clear();
    for_each_history(scenarios, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; i += stride(first, last)) followers_.push_back({scenarios[i], i});
    });
    if (has_values_) split(0, followers_.size(), depth, 1);
    for_each_history(scenarios, [&](std::size_t first, std::size_t last) {
      Earnings by_average;
      Earnings by_rollouts;
      for (std::size_t i = first; i < last; i += stride(first, last)) {
        if (has_values_) by_average.add(earned_[i]);
        if (has_rollouts()) roll_out(scenarios[i].scenario, depth, by_rollouts);
      }
      best_ = !has_values_ || (has_rollouts() && by_rollouts.mean() > by_average.mean()) ? by_rollouts : by_average;
      for (std::size_t i = first; i < last; ++i) {
        bounds_[i].lower = best_.mean();
        bounds_[i].upper = has_values_ ? 0 : best_.sum_of_upper / best_.count();
      }
    });
    return bounds_;
  }
  // The work since `start`. Where nothing but rollouts values states, a rollout counts with all steps that it may take.
  Operations work() const { return work_; }
  // The standard deviation of the returns in the history evaluated last.
  double deviation() const { return best_.deviation(); }

 private:
  static constexpr Operations cost_of_number = 60;  // of a state, in the list
  static constexpr Operations cost_of_certain = 15;  // of the number that the list gives a state before
  static constexpr Operations per_outcome = 2;      // that is passed over
  static constexpr Operations per_rolled_out = operations_of_step * 17 / 20;  // a step of a rollout, with which a search does nothing
  static constexpr Operations per_action = 1;       // of each scenario, where the best one on average is looked for

  struct Earnings : SampleMean {
    double sum_of_upper = 0;  // of the highest returns found
  };

  struct Follower : Observed<Model> {
    std::size_t index;
  };

  // Without a policy in the documents, rollouts are random and say less than MDP values.
  bool has_rollouts() const { return !has_values_ || Model::has_rollout_policy; }
  static std::size_t stride(std::size_t first, std::size_t last) {
    return std::max<std::size_t>((last - first) / max_evaluated, 1);
  }

  // A scenario is copied. What an engine copies that takes larger states does not count: engines decide alike.
  static Operations per_listed_step() {
    return 50 + static_cast<Operations>(std::max(Model::state_bytes(), least_copied_bytes) + 2 * sizeof(std::uint32_t)) / 4;
  }

  // Where states are listed, steps by code are compared with steps by the list. Elsewhere all planners step by code.
  Operations step_cost() const { return has_values_ ? code_cost_ : operations_of_step; }

  Step listed_step(Scenario<Model>& scenario, int action, Sampler& luck, bool& has_ended) {
    const point_based::FlatModel& rows = values_.space().rows();
    const std::size_t row = rows.row(scenario.seen, action);
    work_ += per_listed_step();
    Step step{rows.rewards[row], default_observation};
    double place = luck.uniform();
    for (const auto& outcome : rows.outcomes[row]) {
      work_ += per_outcome;
      if (place >= outcome.probability) {
        place -= outcome.probability;
        continue;
      }
      scenario.seen = outcome.next;
      place /= outcome.probability;
      const auto likelihoods = rows.likelihoods[outcome.sensing];
      std::uint32_t seen = likelihoods.back().observation;
      for (const auto& likelihood : likelihoods) {
        work_ += per_outcome;
        if (place < likelihood.probability) {
          seen = likelihood.observation;
          break;
        }
        place -= likelihood.probability;
      }
      step.observation = static_cast<Observation>(seen);  // by its number: histories need no more
      has_ended = false;
      return step;
    }
    has_ended = true;
    return step;
  }

  void roll_out(const Scenario<Model>& scenario, int depth, Earnings& earnings) {
    const int count = has_values_ ? 1 : rollouts_per_scenario;
    const bool is_listed = has_list_ && scenario.seen != no_state;
    const State start = is_listed ? values_.space()[scenario.seen] : scenario.state;
    double sum = 0;
    double highest = -std::numeric_limits<double>::infinity();
    Sampler random = draws(scenario.number, depth + horizon_);
    for (int i = 0; i < count; ++i) {
      int left = horizon_ - depth;
      const int allowed = left;
      const double found = Model::rollout(start, left, random);
      work_ += has_values_ ? code_cost_ * static_cast<Operations>(allowed - left) : per_rolled_out * static_cast<Operations>(allowed);
      sum += found;
      highest = std::max(highest, found);
    }
    const double origin = has_values_ ? values_.value(scenario.seen, horizon_ - depth) : 0;
    earnings.add(sum / count - origin);
    earnings.sum_of_upper += highest;
  }

  // Splits the followers from `first` to `last` by their last observations.
  void split(std::size_t first, std::size_t last, int depth, double discount) {
    sort_by_observation(followers_, first, last);
    std::size_t kept = first;
    for (std::size_t start = first; start < last;) {
      const std::size_t end = end_of_history(followers_, start, last);
      if (end - start >= smallest_group) {
        follow(start, end, depth, discount);
      } else {
        for (std::size_t i = start; i < end; ++i) followers_[kept++] = followers_[i];
      }
      start = end;
    }
    follow(first, kept, depth, discount);
  }

  // The followers take one action together and go on.
  void follow(std::size_t first, std::size_t last, int depth, double discount) {
    if (first == last || depth == horizon_) return;
    const int action = best_on_average(first, last);
    work_ += (last - first) * per_action * static_cast<Operations>(Model::action_count());
    for (std::size_t i = first; i < last;) {
      Follower& follower = followers_[i];
      const std::uint32_t before = follower.scenario.seen;
      bool has_ended = false;
      const Step step = this->step(follower.scenario, action, depth, has_ended);
      earned_[follower.index] += discount * earned(before, action, depth, step.reward);
      follower.observation = step.observation;
      if (!has_ended) ++i;
      else follower = followers_[--last];
    }
    split(first, last, depth + 1, discount * Model::discount);
  }

  int best_on_average(std::size_t first, std::size_t last) {
    sums_.assign(Model::action_count(), 0);
    for (std::size_t i = first; i < last; ++i) values_.add_action_values(followers_[i].scenario.seen, sums_);
    return static_cast<int>(std::max_element(sums_.begin(), sums_.end()) - sums_.begin());
  }

  MdpValues<Model>& values_;
  bool has_values_ = false;
  bool has_list_ = false;  // of outcomes with what is observed
  Operations code_cost_ = 0;
  int horizon_ = 0;
  std::uint64_t seed_ = 0;
  Operations work_ = 0;
  List<ScenarioBounds> bounds_;
  List<double> earned_;  // by scenario
  Earnings best_;
  List<Follower> followers_;
  List<double> sums_;
};

}
