// Estimates of the fully observable (MDP) values of states, for models whose states are too many to list. They are
// tables over few variables (cell_tables.hpp), learned from simulations by fitted value iteration. They are no bounds.
//
// Examples are states of walks from the belief, which put off their end where another action leads on. Each action is simulated
// once from each example, all under the same luck. One half of the examples chooses the best action and the other one values it,
// since the best of many estimates is too high.
//
// They are used if a policy that follows them earns at least half of what they promise beyond random play, since values fail by
// counting the same income twice, and more than one that follows a few rollouts (Bertsekas and Castanon, 1999).
#pragma once

#include "aos/base/progress.hpp"
#include "aos/base/statistics.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/values/cell_tables.hpp"
#include "aos/planning/values/random_walk.hpp"
#include "aos/planning/values/state_cells.hpp"
#include "aos/planning/values/state_values.hpp"
#include "aos/planning/values/value_constants.hpp"

namespace aos {

template <class Model>
class LearnedValues final : public StateValues<Model> {
 public:
  using State = typename Model::State;

  // Learns once, from the first belief. Returns whether the values can be used. The work is limited in steps
  // and not in time, so that decisions can be repeated.
  bool prepare(const Belief<Model>& belief, int horizon, Sampler& random) {
    if (has_tried_) return is_usable_;
    if (Model::action_count() == 0 || belief.probability_of(Ending::running) <= 0) return false;
    const ForgottenTexts forgotten;
    has_tried_ = true;
    horizon_ = horizon;
    const bool are_learned = std::any_of(std::begin(learning_efforts), std::end(learning_efforts), [&](const LearningEffort& effort) {
      learn(belief, effort, random);
      return keeps_its_promise(belief, random);
    });
    is_usable_ = are_learned && beats_rollouts(belief, random);
    examples_ = {};
    rows_ = {};
    successors_ = {};
    return is_usable_;
  }

  // The value of a state; 0 without decisions to go. Otherwise it does not depend on `left`.
  double value(const State& state, int left) const override {
    if (left <= 0) return 0;
    return std::clamp(tables_.value(cells_.row(state, used_)), lowest_, highest_);
  }

  // By one step of each action, all under the same luck.
  void advantages(const State& state, double* worths, Sampler& random) const override {
    const double now = value(state, horizon_);
    const Sampler luck{random.bits()};
    for (int a = 0; a < Model::action_count(); ++a) worths[a] = this->stepped_value(state, a, horizon_, luck) - now;
  }

 private:
  static constexpr std::size_t walks_between_looks = 64;  // at the progress

  struct Successor {
    float reward;
    std::int32_t row;  // or -1 for an end
  };

  static std::size_t action_count() { return static_cast<std::size_t>(Model::action_count()); }

  void forget() {
    examples_.clear();
    cells_.forget();
    used_.clear();
    tables_ = CellTables{};
    lowest_ = highest_ = 0;
  }

  void learn(const Belief<Model>& belief, const LearningEffort& effort, Sampler& random) {
    forget();
    for (int round = 0; round < effort.rounds; ++round) {
      walk(belief, effort.successors, random, round > 0);
      if (examples_.empty() || (round == 0 && !find_variables())) return;
      simulate_all_actions(random);
      for (int sweep = 0; sweep < std::min(learning_sweeps, horizon_); ++sweep) {
        progress::tell("learning what states are worth", sweep, learning_sweeps);
        improve();
      }
      used_ = tables_.used_variables();
    }
  }

  // --- examples

  // Takes one example from each walk, since states of the same walk have too much in common.
  void walk(const Belief<Model>& belief, std::size_t successors, Sampler& random, bool has_values) {
    const std::size_t more = std::min(successors / action_count(), max_example_bytes / Model::state_bytes());
    const std::size_t wanted = examples_.size() + std::max<std::size_t>(more, 100);
    for (std::size_t walks = 0; examples_.size() < wanted && walks < 4 * wanted; ++walks) {
      if (walks % walks_between_looks == 0) progress::tell("learning what states are worth", examples_.size(), wanted);
      State state = belief.sample(random);
      const int stop = random.below(horizon_);
      const int at_random = has_values && walks % 2 == 1 ? random.below(stop + 1) : stop;
      walk_.start();
      for (int i = 0; i < stop && Model::ending(state) == Ending::running; ++i) {
        const int action = i >= at_random ? best_action(state, horizon_ - i, random) : walk_.next(state, random);
        step_on(state, action, random);
      }
      if (Model::ending(state) == Ending::running) examples_.push_back(state);
    }
  }

  // Takes the action, or another one where the walk would end.
  void step_on(State& state, int action, Sampler& random) {
    for (int attempt = 1;; ++attempt) {
      State next = state;
      Model::step(next, action, random);
      if (Model::ending(next) == Ending::running || attempt == attempts_to_go_on) {
        state = std::move(next);
        return;
      }
      walk_.start();
      action = walk_.next(state, random);
    }
  }

  int best_action(const State& state, int left, Sampler& random) const {
    const Sampler luck{random.bits()};
    return best_by([&](int action) { return this->stepped_value(state, action, left, luck); }, random);
  }
  static int best_by(auto&& worth_of, Sampler& random) {
    const bool compares_all = Model::action_count() <= max_compared_actions;
    int actions[max_compared_actions]{};
    const auto worth = [&](int i) { return worth_of(actions[i] = compares_all ? i : random.below(Model::action_count())); };
    return actions[best_of(compared(), worth)];
  }
  static int compared() { return std::min(Model::action_count(), max_compared_actions); }

  bool find_variables() {
    if (!cells_.find(examples_)) return false;
    tables_ = CellTables{cells_.variables()};
    return true;
  }

  void simulate_all_actions(Sampler& random) {
    const std::size_t room = max_example_cells / (cells_.size() * (action_count() + 1));
    if (examples_.size() > room) examples_.resize(std::max<std::size_t>(room, 2));
    rows_.clear();
    successors_.clear();
    for (const State& example : examples_) cells_.add_row(example, rows_);
    auto next_row = static_cast<std::int32_t>(examples_.size());
    for (const State& example : examples_) {
      const Sampler luck{random.bits()};
      for (int action = 0; action < Model::action_count(); ++action) {
        State state = example;
        Sampler draws = luck;
        const Step step = Model::step(state, action, draws);
        const bool goes_on = Model::ending(state) == Ending::running;
        successors_.push_back({static_cast<float>(step.reward), goes_on ? next_row++ : -1});
        if (goes_on) cells_.add_row(state, rows_);
      }
    }
  }

  // --- values

  // One sweep of fitted value iteration.
  void improve() {
    targets_.resize(examples_.size());
    for (std::size_t i = 0; i < examples_.size(); ++i) {
      const std::size_t own = i % 2;
      double most = -std::numeric_limits<double>::infinity();
      for (std::size_t a = 0; a < action_count(); ++a) {
        const Successor& next = successors_[i * action_count() + a];
        std::array<double, 2> later{};
        if (next.row >= 0) later = tables_.values(&rows_[static_cast<std::size_t>(next.row) * cells_.size()]);
        const double worth = next.reward + Model::discount * std::clamp(later[own], lowest_, highest_);
        if (worth <= most) continue;
        most = worth;
        targets_[i] = next.reward + Model::discount * std::clamp(later[1 - own], lowest_, highest_);
      }
    }
    const auto [lowest, highest] = std::minmax_element(targets_.begin(), targets_.end());
    lowest_ = std::min(*lowest, 0.0);
    highest_ = std::max(*highest, 0.0);
    tables_.fit(rows_, targets_);
  }

  bool keeps_its_promise(const Belief<Model>& belief, Sampler& random) const {
    double promised = 0;
    double earned = 0;
    double at_random = 0;
    for (int test = 0; test < tested_missions; ++test) {
      const State& state = belief.sample(random);
      if (Model::ending(state) != Ending::running) continue;
      promised += value(state, horizon_);
      int left = horizon_;
      at_random += Model::rollout(state, left, random);
      earned += earned_by_values(state, random);
    }
    return earned > at_random && earned >= (promised + at_random) / 2;
  }

  // Compares both policies from the same states. The difference must exceed `sure_errors` standard errors.
  bool beats_rollouts(const Belief<Model>& belief, Sampler& random) const {
    SampleMean differences;
    std::size_t steps = 0;
    for (int test = 0; test < tested_missions && steps < max_tested_steps; ++test) {
      progress::tell("testing what states are worth", test, tested_missions);
      const State& state = belief.sample(random);
      if (Model::ending(state) != Ending::running) continue;
      differences.add(earned_by_values(state, random) - earned_by_rollouts(state, random, steps));
    }
    return differences.count() >= min_compared_missions && differences.mean() > sure_errors * differences.error();
  }

  // The discounted return of one mission whose policy observes the state.
  double earned_by(State state, auto&& choice, Sampler& random) const {
    const auto take = [&](int step) { return Model::step(state, choice(state, horizon_ - step), random).reward; };
    return earned_in<Model>(horizon_, state, take).sum;
  }
  double earned_by_values(const State& state, Sampler& random) const {
    return earned_by(state, [&](const State& now, int left) { return best_action(now, left, random); }, random);
  }
  double earned_by_rollouts(const State& state, Sampler& random, std::size_t& steps) const {
    const int rollouts = std::max(1, max_tested_rollouts / compared());
    const auto worth = [&](const State& now, int action, int left) {
      double sum = 0;
      for (int i = 0; i < rollouts; ++i) {
        State next = now;
        int after = left - 1;
        sum += Model::step(next, action, random).reward;
        sum += Model::discount * Model::rollout(next, after, random);
        steps += left;
      }
      return sum;
    };
    const auto choice = [&](const State& now, int left) {
      return best_by([&](int action) { return worth(now, action, left); }, random);
    };
    return earned_by(state, choice, random);
  }

  bool has_tried_ = false;
  bool is_usable_ = false;
  int horizon_ = 0;
  StateCells<Model> cells_;
  List<std::uint32_t> used_;
  CellTables tables_;
  double lowest_ = 0;
  double highest_ = 0;
  RandomWalk<Model> walk_;
  // While learning:
  List<State> examples_;
  List<std::uint16_t> rows_;    // of the examples, then of all successors
  List<Successor> successors_;  // by example and action
  List<double> targets_;
};

}
