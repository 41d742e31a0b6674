// Rollouts: the value of a state under the documents' rollout policy, or else under random actions, by simulation.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/model/build_kind.hpp"
#include "aos/model/step.hpp"

namespace aos {

// If the documents give a state heuristic, a rollout ends with it before each step with this probability.
inline constexpr double heuristic_ending = 0.75;
// The share of the random rollouts that repeat their actions. Where the way to a reward is long, a rollout that turns at
// every step stays where it is. Where a repeated action harms, the other rollouts tell what a state is worth.
//
// Rollouts that repeat also put off an end that earns nothing, such as an exit or an accident, by drawing another action
// (anti-decisive moves: Teytaud and Teytaud, 2010). Where an exit is open at every step, few other rollouts get far.
inline constexpr double share_of_repeating = 0.5;

// Memory of this thread for so many weights of a rollout policy. It is defined with the engine, so that models compile sooner.
double* memory_for_weights(std::size_t count);

// How many times a random walk takes its next action (Dabney, Ostrovski and Barreto, 2021).
inline int drawn_repeats(Sampler& random) { return 1 << random.below(4); }

namespace detail {

// The first action whose running sum of weights exceeds `drawn`, or the last one with a weight if rounding leaves none.
inline int action_at(const double* sums, int count, double drawn) {
  int action = 0;
  for (int i = 0; i < count - 1; ++i) action += sums[i] <= drawn;
  while (action > 0 && sums[action] == sums[action - 1]) --action;
  return action;
}

// Sets the weight of an action to zero.
inline void leave_out(double* sums, int count, int action) {
  const double before = action > 0 ? sums[action - 1] : 0;
  const double weight = sums[action] - before;
  sums[action] = before;
  for (int i = action + 1; i < count; ++i) sums[i] -= weight;
}

// Draws an action whose precondition holds, with the weights of the documents' rollout policy. If no such
// action has a weight, all of them are equally likely. After too many attempts, any action is taken.
template <class Model>
int rollout_action(const typename Model::State& state, double* sums, int count, Sampler& random) {
  ModelSource<Sampler> draws{random};
  if constexpr (Model::has_rollout_policy) {
    double total = 0;
    int filled = 0;
    Model::rollout_weights(state, draws, [&](double weight) { sums[filled++] = total += weight; });
    for (int left = count; total > 0 && left > 0; --left) {
      const int action = action_at(sums, count, random.uniform() * total);
      if (Model::meets_precondition(state, action, draws)) return action;
      leave_out(sums, count, action);
      total = sums[count - 1];
    }
  }
  for (int attempt = 0; attempt < 2 * count; ++attempt) {
    const int action = random.below(count);
    if (Model::meets_precondition(state, action, draws)) return action;
  }
  return random.below(count);
}

}  // namespace detail

// Writes to `odds` the probability with which a rollout takes each action in a state.
template <class Model>
void rollout_odds(const typename Model::State& state, double* odds, int count, Sampler& random) {
  double total = 0;
  const auto leave_out_what_cannot_run = [&] {
    for (int action = 0; action < count; ++action) {
      if (!Model::meets_precondition(state, action, random)) odds[action] = 0;
      total += odds[action];
    }
  };
  if constexpr (Model::has_rollout_policy) {
    int filled = 0;
    Model::rollout_weights(state, random, [&](double weight) { odds[filled++] = weight; });
    leave_out_what_cannot_run();
  }
  if (total == 0) {
    std::fill_n(odds, count, 1.0);
    leave_out_what_cannot_run();
  }
  for (int action = 0; action < count; ++action) odds[action] = total > 0 ? odds[action] / total : 1.0 / count;
}

// The discounted return of at most `left` steps from `start` on. `left` becomes the number of steps that were not taken.
template <class Model>
AOS_INLINING_ALL double rollout(const typename Model::State& start, int& left, Sampler& random) {
  const int count = Model::action_count();
  double* sums = nullptr;
  if constexpr (Model::has_rollout_policy) sums = memory_for_weights(static_cast<std::size_t>(count));
  Sampler draws = random;  // nothing points to it, so a compiler keeps it in registers
  ModelSource<Sampler> model_draws{draws};
  typename Model::State state = start;
  double sum = 0;
  double discount = 1;
  const bool repeats = !Model::has_rollout_policy && draws.flag(share_of_repeating);
  int action = 0;
  int times = 0;  // how often the action is still to be repeated
  const auto draw_action = [&] {
    action = detail::rollout_action<Model>(state, sums, count, draws);
    times = repeats && switches::rollout_repeats ? drawn_repeats(draws) - 1 : 0;
  };
  const auto take_action = [&]() -> Step {
    if (!repeats || !switches::rollout_ends) return Model::step(state, action, model_draws);
    typename Model::State before = state;
    const Step step = Model::step(state, action, model_draws);
    if (step.reward > 0 || Model::ending(state) == Ending::running) return step;
    state = std::move(before);
    draw_action();
    return Model::step(state, action, model_draws);
  };
  int to_go = left;
  for (; to_go > 0 && Model::ending(state) == Ending::running; --to_go) {
    if constexpr (Model::has_state_heuristic) {
      if (draws.flag(heuristic_ending)) {
        sum += discount * Model::state_value(state, model_draws);
        break;
      }
    }
    if (times-- <= 0 || !Model::meets_precondition(state, action, model_draws)) draw_action();
    const Step step = take_action();
    sum += discount * step.reward;
    discount *= Model::discount;
  }
  random = draws;
  left = to_go;
  return sum;
}

}  // namespace aos
