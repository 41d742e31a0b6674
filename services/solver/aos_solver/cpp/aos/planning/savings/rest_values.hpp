// What a state is worth to a robot that does not plan: one that rests, or one that acts at random. To rest is to take the one
// action for ever that returns most so. The values are tables over few variables (cell_tables.hpp), fitted to simulated
// returns, first of whole missions, then of an eighth of their steps and what the first tables tell of the state after it:
// less of that is luck, which hides what an action does.
//
// To a robot that never attends to a thing again, or only by chance, to attend to it now is worth too much, and it is done too early.
// So the values of chance can be improved: they become those of a robot that sees the state and takes what is best by them.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/base/progress.hpp"
#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/values/cell_tables.hpp"
#include "aos/planning/values/random_walk.hpp"
#include "aos/planning/values/state_cells.hpp"

namespace aos {

// The seeds of steps to come, under which ways of acting are compared: their draws at a step do not depend on those before.
class StepLuck {
 public:
  explicit StepLuck(Sampler& random) : seed_(random.bits()) {}
  Sampler of(std::size_t step) const { return Sampler{mixed(seed_, step)}; }

 private:
  std::uint64_t seed_;
};

// A policy that does not plan.
enum class BasePolicy { rest, random };

template <class Model>
class RestValues {
 public:
  using State = typename Model::State;

  // Learns from a belief whose running part is not empty. Returns whether values tell states apart. The work is limited in
  // steps and not in time, so that decisions can be repeated.
  bool learn(BasePolicy base, const Belief<Model>& belief, int horizon, Sampler& random) {
    horizon_ = horizon;
    used_.clear();
    find_action(belief, random);
    const List<State> examples = walked(belief, affordable_examples(horizon_), random);
    if (examples.empty() || !cells_.find(examples)) return false;
    List<std::uint16_t> rows;
    List<double> targets;
    for (const State& example : examples) {
      tell(targets.size(), examples.size());
      cells_.add_row(example, rows);
      targets.push_back(returned_by(base, horizon_, example, random));
    }
    fit(rows, targets);
    if (used_.empty()) return false;
    for (std::size_t i = 0; i < examples.size(); ++i) {
      tell(i, examples.size());
      targets[i] = 0;
      for (int j = 0; j < nearer; ++j) targets[i] += returned_by(base, settling(), examples[i], random) / nearer;
    }
    fit(rows, targets);
    return !used_.empty();
  }

  // Improves what was learned: for some steps the action is taken that is best by the values so far, and so on. Returns whether
  // values tell states apart.
  bool improve(const Belief<Model>& belief, Sampler& random) {
    const double of_choice = 2.0 * (Model::action_count() + 1);  // a value takes about as long as a step
    const List<State> examples = walked(belief, affordable_examples(of_choice * static_cast<double>(settling())), random);
    List<std::uint16_t> rows;
    for (const State& example : examples) cells_.add_row(example, rows);
    List<double> targets(examples.size());
    for (int round = 0; round < rounds && !used_.empty(); ++round) {
      for (std::size_t i = 0; i < examples.size(); ++i) {
        tell(i, examples.size());
        targets[i] = returned_in(settling(), examples[i], [&](const State& state) { return best_action(state, random); },
                                 [&](State& state, int taken, std::size_t) { return Model::step(state, taken, random); });
      }
      fit(rows, targets);
    }
    return !used_.empty();
  }

  // What an action returns that is taken for ever.
  double returned(int action, const State& start, const StepLuck& luck) const {
    return returned_in(horizon_, start, [&](const State&) { return action; }, [&](State& state, int taken, std::size_t step) {
      Sampler random = luck.of(step);
      return Model::step(state, taken, random);
    });
  }
  // How many rests follow a way before its states are valued: what an action does later counts then, where no table tells it.
  std::size_t settling() const { return static_cast<std::size_t>(std::max(horizon_ / nearer, 1)); }
  // The action of the rest.
  int action() const { return action_; }
  // What a state is worth; 0 where the mission is over.
  double value(const State& state) const {
    return Model::ending(state) == Ending::running ? tables_.value(cells_.row(state, used_)) : 0;
  }

 private:
  static constexpr double max_steps = 600'000;  // of the model, for examples
  static constexpr std::size_t fewest_examples = 200;
  static constexpr std::size_t most_examples = 20'000;
  static constexpr std::size_t examples_between_looks = 64;
  static constexpr std::size_t sweeps = 30;
  static constexpr int rounds = 3;  // of improvement
  static constexpr int nearer = 8;  // returns of each example at last, of so many times fewer steps
  static constexpr int first_tries = 4;  // of each action, with other states; four times as many of each better quarter
  static constexpr std::size_t kept_share = 4;

  static void tell(std::size_t done, std::size_t all) {
    if (done % examples_between_looks == 0) progress::tell("learning what states are worth", done, all);
  }

  // Sequential halving: all actions are tried under the same luck, the better quarter of them four times as often, and so on.
  void find_action(const Belief<Model>& belief, Sampler& random) {
    List<int> actions(Model::action_count());
    std::iota(actions.begin(), actions.end(), 0);
    for (int tries = first_tries; actions.size() > 1; tries *= static_cast<int>(kept_share)) {
      List<double> sums(Model::action_count(), 0);
      for (int i = 0; i < tries; ++i) {
        const State& state = belief.sample(random);
        if (Model::ending(state) != Ending::running) continue;
        const StepLuck luck{random};
        for (const int action : actions) sums[action] += returned(action, state, luck);
      }
      sort_stably(actions, [&](int one, int other) { return sums[one] > sums[other]; });
      actions.resize(std::max<std::size_t>(actions.size() / kept_share, 1));
    }
    action_ = actions.front();
  }

  void fit(const List<std::uint16_t>& rows, const List<double>& targets) {
    CellTables tables{cells_.variables()};
    for (std::size_t i = 0; i < sweeps; ++i) {
      progress::tell("learning what states are worth", i, sweeps);
      tables.fit(rows, targets);
    }
    tables_ = std::move(tables);
    used_ = tables_.used_variables();
  }

  // What a policy returns in so many steps, given its actions and the draws of its steps, and in fewer than the mission has
  // with what the state after them is worth.
  double returned_in(std::size_t steps, State state, auto&& choice, auto&& luck) const {
    const auto [sum, discount] = earned_in<Model>(steps, state, [&](std::size_t i) { return luck(state, choice(state), i).reward; });
    return steps < static_cast<std::size_t>(horizon_) ? sum + discount * value(state) : sum;
  }
  double returned_by(BasePolicy base, std::size_t steps, const State& start, Sampler& random) {
    walk_.start();
    return returned_in(steps, start, [&](const State& state) { return base == BasePolicy::rest ? action_ : walk_.next(state, random); },
                       [&](State& state, int taken, std::size_t) { return Model::step(state, taken, random); });
  }

  // The best action by the values, under the same luck for all.
  int best_action(const State& state, Sampler& random) const {
    const Sampler luck{random.bits()};
    return best_of(Model::action_count(), [&](int action) {
      State next = state;
      Sampler same = luck;
      const double reward = Model::step(next, action, same).reward;
      return reward + Model::discount * value(next);
    });
  }

  static std::size_t affordable_examples(double steps_of_example) {
    return std::clamp(static_cast<std::size_t>(max_steps / std::max(steps_of_example, 1.0)), fewest_examples, most_examples);
  }

  // Takes a state from each of so many random walks.
  List<State> walked(const Belief<Model>& belief, std::size_t wanted, Sampler& random) {
    List<State> examples;
    for (std::size_t walks = 0; examples.size() < wanted && walks < 4 * wanted; ++walks) {
      State state = belief.sample(random);
      const int steps = random.below(horizon_);
      walk_.take(state, steps, random);
      if (Model::ending(state) == Ending::running) examples.push_back(std::move(state));
    }
    return examples;
  }

  int horizon_ = 1;
  int action_ = 0;
  StateCells<Model> cells_;
  CellTables tables_;
  List<std::uint32_t> used_;
  RandomWalk<Model> walk_;
};

}
