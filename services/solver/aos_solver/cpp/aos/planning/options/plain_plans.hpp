// Plain plans: the same action again and again, as far as the mission goes on. To leave, to land or to wait is one of them.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/sampled_belief.hpp"

namespace aos {

// What a plain plan returns from the states of a belief, on average, with its standard error, and the probability that the mission goes on
// after it.
struct PlainPlan {
  int action = -1;  // none
  double returned = 0;
  double error = 0;
  double goes_on = 1;
};

template <class Model>
class PlainPlans {
 public:
  using State = typename Model::State;

  // The plan that returns most over `horizon` decisions (sequential halving). What the last one returns is found anew, since the
  // mean of the best of several is too high. It takes at most so many steps to choose.
  static PlainPlan best(const SampledBelief<Model>& belief, int horizon, const BarredActions& barred, double steps, Sampler& random) {
    List<int> actions;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (!barred.contains(action)) actions.push_back(action);
    }
    if (actions.empty()) return {};
    const double of_round = steps / rounds;
    List<double> sums(Model::action_count());
    for (std::size_t tries = first_tries; actions.size() > 1; tries *= kept_share) {
      const double affordable = of_round / (actions.size() * tries);
      const int length = std::clamp(static_cast<int>(affordable), 1, horizon);
      for (const int action : actions) sums[action] = played(action, belief, tries, length, random).returned;
      sort_stably(actions, [&](int one, int other) { return sums[one] > sums[other]; });
      actions.resize(std::max<std::size_t>(actions.size() / kept_share, 1));
    }
    return played(actions.front(), belief, last_tries, horizon, random);
  }

  // How much less each plan, up to its end, returns than if each of its steps returned what its first one does: the least of that,
  // or the first that is `enough` or less.
  static double least_decay(const SampledBelief<Model>& belief, int horizon, double enough, Sampler& random) {
    double least = std::numeric_limits<double>::infinity();
    for (int action = 0; action < Model::action_count() && least > enough; ++action) least = std::min(least, decay(action, belief, horizon, random));
    return least;
  }

  // What an action returns that is taken so many times.
  static PlainPlan played(int action, const SampledBelief<Model>& belief, std::size_t tries, int length, Sampler& random) {
    SampleMean mean;
    double running = 0;
    draw_states(belief.weights(), tries, random, [&](std::size_t k) {
      State state = belief.states()[k];
      mean.add(earned_in<Model>(length, state, [&](std::size_t) { return Model::step(state, action, random).reward; }).sum);
      running += Model::ending(state) == Ending::running ? 1 : 0;
    });
    return {action, mean.mean(), mean.error(), running / mean.count()};
  }

 private:
  static constexpr std::size_t first_tries = 4;  // of each action; four times as many of each better quarter
  static constexpr std::size_t kept_share = 4;
  static constexpr double rounds = 4;
  static constexpr std::size_t last_tries = 64;

  // Less two standard errors. To leave, or to reach a goal, is no decay.
  static double decay(int action, const SampledBelief<Model>& belief, int horizon, Sampler& random) {
    const double first = played(action, belief, last_tries, 1, random).returned;
    SampleMean mean;
    draw_states(belief.weights(), last_tries, random, [&](std::size_t k) {
      State state = belief.states()[k];
      const auto lost = [&](std::size_t) {
        const double reward = Model::step(state, action, random).reward;
        return Model::ending(state) == Ending::running || Model::ending(state) == Ending::failure ? first - reward : 0;
      };
      mean.add(earned_in<Model>(horizon, state, lost).sum);
    });
    return mean.mean() - 2 * mean.error();
  }
};

}
