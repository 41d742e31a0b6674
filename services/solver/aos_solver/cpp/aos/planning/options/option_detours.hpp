// What to find out where all that was tried is a lost step, which the robot would take for ever: ways of at most two moves with
// an observation after them, made several times. It may change the state, as a camera does that drains the battery.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/repeated_observation.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

// What comes after a way is worth what a robot returns that takes options or none, and waits for ever then. So an end counts that
// loses less than to wait, and what leads to it.
template <class Model>
class OptionDetours {
 public:
  using State = typename Model::State;

  OptionDetours(const SampledBelief<Model>& belief, const OptionGains<Model>& gains, const DecisionClock& clock)
      : belief_(belief), gains_(gains), clock_(clock) {}

  // The ways that are found, if waiting returns so much. `steps` is counted down.
  List<OptionCandidate> find(const List<int>& moves, double waiting, const BarredActions& barred, double& steps, Sampler& random) {
    waiting_ = waiting;
    looks_.clear();
    telling_.assign(Model::action_count(), false);
    double weighing = steps / 2;
    steps -= weighing;
    List<Ahead> ones{{{}, belief_.states()}};
    look_after(ones.front(), barred, false, steps, random);
    for (const int move : moves) {
      ones.push_back(after(ones.front(), move, steps, random));
      look_after(ones.back(), barred, false, steps, random);
    }
    for (std::size_t i = 1; i < ones.size(); ++i) {
      for (const int move : moves) look_after(after(ones[i], move, steps, random), barred, true, steps, random);
    }
    sort_stably(looks_, [](const Look& one, const Look& other) { return one.ahead.paid > other.ahead.paid; });
    List<OptionCandidate> found;
    for (const Look& look : looks_) {
      if (weighing > 0 && !clock_.is_over()) weigh(look, found, weighing);
    }
    steps += weighing;
    return found;
  }
  // What an option returns, the best ones after it, and to wait for ever then.
  double returned(std::size_t option, const StateWeights& weights) const {
    const StateWeights then = gains_.after(option, weights);
    return gains_.earned(option, weights) + gains_.discount(option) * (sum(then) * waiting_ + gains_.best(then, option));
  }

 private:
  static constexpr int most_times = 4;
  static constexpr std::size_t first_states = 16;  // in which an action is to tell something that told nothing yet

  // Where some moves lead, which go on for certain if `goes_on`.
  struct Ahead {
    Option way;
    List<State> states;
    double paid = 0;
    double discount = 1;
    bool goes_on = true;
  };
  struct Look {
    Ahead ahead;
    int action;
    List<StepReports> reports;  // by state
    double reward = 0;
  };

  Ahead after(Ahead ahead, int move, double& steps, Sampler& random) {
    StepReports unread;
    ahead.way.push_back(move);
    ahead.goes_on = ahead.goes_on && steps > 0 && !clock_.is_over();
    for (std::size_t k = 0; k < ahead.states.size() && ahead.goes_on; ++k) {
      ahead.paid += ahead.discount * belief_.weights()[k] * step_.take(ahead.states[k], move, unread, steps, random);
      ahead.goes_on = Model::ending(ahead.states[k]) == Ending::running;
    }
    ahead.discount *= Model::discount;
    return ahead;
  }

  // Notes what can be observed after some moves. Of ways to observe the same the cheapest is kept. `known` leaves out what has told
  // nothing elsewhere.
  void look_after(const Ahead& ahead, const BarredActions& barred, bool known, double& steps, Sampler& random) {
    for (int action = 0; action < Model::action_count() && ahead.goes_on && steps > 0 && !clock_.is_over(); ++action) {
      const std::size_t a = action;
      if (barred.contains(a) || (known && !telling_[a])) continue;
      Look look{ahead, action, {}};
      bool goes_on = true;
      for (std::size_t k = 0; k < ahead.states.size() && goes_on; ++k) {
        if (k == first_states && !telling_[a] && RepeatedObservation{look.reports}.tells_nothing()) break;
        State state = ahead.states[k];
        look.reward += belief_.weights()[k] * step_.take(state, action, look.reports.emplace_back(), steps, random);
        goes_on = Model::ending(state) == Ending::running;
      }
      const RepeatedObservation observation{look.reports};
      if (!goes_on || !observation.is_listed(1) || observation.tells_nothing()) continue;
      telling_[a] = true;
      const auto same = std::ranges::find_if(looks_, [&](const Look& other) {
        return other.action == action && std::ranges::equal(other.reports, look.reports, &StepReports::is_like);
      });
      if (same == looks_.end()) looks_.push_back(std::move(look));
      else if (look.ahead.paid > same->ahead.paid) *same = std::move(look);
    }
  }

  void weigh(const Look& look, List<OptionCandidate>& found, double& steps) const {
    constexpr double of_gain = 0.03;  // as many steps of the model take as long as to find what an option returns in a state
    const RepeatedObservation observation{look.reports};
    Earned<Model> paid{look.ahead.paid, look.ahead.discount};
    Option way = look.ahead.way;
    for (int times = 1; times <= most_times && observation.is_listed(times); ++times) {
      paid.add(look.reward);
      way.push_back(look.action);
      double later = 0;
      observation.for_each(belief_.weights(), times, [&](double probability, const StateWeights& weights) {
        later += probability * worth(weights);
        steps -= of_gain * (gains_.size() * weights.size());
      });
      found.push_back({way.front(), paid.sum + paid.discount * later, paid.discount, "what can be observed after a detour", {}, way});
    }
  }

  double worth(const StateWeights& weights) const {
    double most = waiting_ + gains_.best(weights);
    for (std::size_t o = 0; o < gains_.size(); ++o) {
      most = std::max(most, gains_.earned(o, weights) + gains_.discount(o) * waiting_ * sum(gains_.after(o, weights)));
    }
    return most;
  }
  static double sum(const StateWeights& weights) { return std::accumulate(weights.begin(), weights.end(), 0.0); }

  const SampledBelief<Model>& belief_;
  const OptionGains<Model>& gains_;
  const DecisionClock& clock_;
  ReportedStep<Model> step_;
  double waiting_ = 0;
  std::vector<bool> telling_;  // by action
  List<Look> looks_;
};

}
