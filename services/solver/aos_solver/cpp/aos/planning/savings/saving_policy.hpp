// Decides where nothing is rewarded and what is neglected costs: which way saves most in each step against a rest.
//
// A few states of the belief stand for it. Ways are found by searches from some of them (saving_search.hpp), kept from
// decision to decision with what is left of each after its first actions, and valued from all states (saving_index.hpp).
// States after a way are worth what a robot returns that rests, one that acts at random, or one that sees the state and acts by
// the values of chance. A rest tells what is saved best. It knows nothing of what serves later only, such as a tank that is full,
// and chance does. Both attend to things too early, as if nothing could be done later. Missions tell which one to go by.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/savings/rest_values.hpp"
#include "aos/planning/savings/saving_index.hpp"
#include "aos/planning/savings/saving_lookahead.hpp"
#include "aos/planning/values/leaf_cells.hpp"

namespace aos {

template <class Model>
class SavingPolicy {
 public:
  using State = typename Model::State;

  // Learns what states are worth, once in a mission. Returns whether ways are found.
  bool learn(const Belief<Model>& belief, int horizon, Sampler& random) {
    if (has_learned_) return index_ != nullptr;
    const ForgottenTexts forgotten;
    has_learned_ = true;
    index_ = nullptr;
    cells_.prepare(belief, random);
    double most = -std::numeric_limits<double>::infinity();
    const auto note = [&](SavingIndex<Model>& index, double returned) {
      if (returned <= most) return;
      most = returned;
      index_ = &index;
      seen_ = returned - mean_value(belief, index, random);
    };
    note(by_rest_, by_rest_.learn(BasePolicy::rest, cells_, belief, horizon, Sampler{random.bits()}));
    note(by_chance_, by_chance_.learn(BasePolicy::random, cells_, belief, horizon, Sampler{random.bits()}));
    if (switches::later_attention) note(by_sight_, by_sight_.improve(by_chance_, cells_, belief, horizon, Sampler{random.bits()}));
    return index_ != nullptr;
  }

  // Draws states, and finds and values ways. It may take so many steps of the model.
  void prepare(const Belief<Model>& belief, double affordable, const BarredActions& barred, Sampler random) {
    const ForgottenTexts forgotten;
    double steps = affordable;
    const auto states = std::clamp<double>(of_states * affordable / Model::action_count(), 16, 32);
    belief_.draw(belief, static_cast<std::size_t>(states), random);
    index_->drop_worst();
    const double least = (1 - of_search) * affordable;
    for (std::size_t i = 0; i < searched && steps > least; ++i) {
      const std::size_t k = random.below(belief_.size());
      double left = steps - least;
      steps -= left;
      index_->extend(cells_, belief_.states()[k], left, random);
      steps += left;
    }
    index_->measure(belief_.states(), belief_.weights(), steps, random);
    look_ahead(barred, steps, random);
    taken_ = affordable - steps;
  }

  // Decides for the belief of `prepare`. Returns the work as simulations.
  std::uint64_t search(const Belief<Model>& belief, int horizon) {
    estimates_.assign(Model::action_count(), {});
    const double running = belief.probability_of(Ending::running);
    const double rest = belief_.mean([&](std::size_t k) { return index_->values().value(belief_.states()[k]); });
    resting_ = running * rest;
    for (const auto& [action, income] : found_) settle(action, running * (rest + income));
    return 1 + static_cast<std::uint64_t>(taken_ / horizon);
  }

  // The steps of the model that `prepare` took.
  double taken() const { return taken_; }
  const Estimates& estimates() const { return estimates_; }
  // What the belief of the last decision is worth to a robot that does not plan.
  double resting() const { return resting_; }
  // How much more missions return that see the state.
  double seen() const { return seen_; }
  // What a state is worth to such a robot, and what its actions save then.
  const StateValues<Model>& worths() const { return *index_; }

  void start_over() { has_learned_ = false; }

 private:
  struct Found {
    int action;
    double income;
  };

  static constexpr double of_states = 0.05;
  static constexpr double of_search = 0.3;  // of the steps; the others look ahead
  static constexpr int drawn = 64;  // states that tell what a belief is worth
  static constexpr std::size_t searched = 2;      // states
  static constexpr std::size_t fewest_tried = 4;  // actions

  static double mean_value(const Belief<Model>& belief, const SavingIndex<Model>& index, Sampler& random) {
    double sum = 0;
    draw_evenly<Model>(belief.particles(), drawn, random, [&](const State& state) { sum += index.values().value(state) / drawn; });
    return sum;
  }

  // Finds the incomes of actions, those that begin the best ways first, then those that tell most.
  void look_ahead(const BarredActions& barred, double& steps, Sampler& random) {
    found_.clear();
    if (!switches::saving_lookahead) {
      for (std::size_t i = 0; i < index_->ways().size(); ++i) {
        const int first = index_->ways()[i].front();
        if (!barred.contains(first)) found_.push_back({first, index_->income_of(i)});
      }
      return;
    }
    SavingLookahead<Model> lookahead{index_->values(), index_->ways()};
    lookahead.begin(belief_, random);
    const double of_action = lookahead.steps_of_action();
    for (const int action : ordered_actions(steps, random)) {
      if (barred.contains(action)) continue;
      if (steps <= 0 && found_.size() >= fewest_tried) break;
      found_.push_back({action, lookahead.income_of(action)});
      steps -= of_action;
    }
  }

  // The actions by the income of the best way that begins with each; those that begin none by what they tell.
  List<int> ordered_actions(double& steps, Sampler& random) {
    const std::size_t actions = Model::action_count();
    constexpr double none = -std::numeric_limits<double>::infinity();
    List<double> incomes(actions, none);
    incomes[index_->values().action()] = 0;
    for (std::size_t i = 0; i < index_->ways().size(); ++i) {
      double& income = incomes[index_->ways()[i].front()];
      income = std::max(income, index_->income_of(i));
    }
    List<double> told(actions, 0);
    List<int> ordered(actions);
    std::iota(ordered.begin(), ordered.end(), 0);
    for (std::size_t a = 0; a < actions; ++a) {
      if (incomes[a] == none) told[a] = told_by(a, steps, random);
    }
    const auto worth = [&](int action) {
      const std::size_t a = action;
      return std::pair{incomes[a], told[a]};
    };
    sort_stably(ordered, [&](int one, int other) { return worth(one) > worth(other); });
    return ordered;
  }

  // The entropy of what is observed after an action.
  double told_by(int action, double& steps, Sampler& random) const {
    std::map<Observation, double> shares;
    for (std::size_t k = 0; k < belief_.size(); ++k) {
      State state = belief_.states()[k];
      shares[Model::step(state, action, random).observation] += belief_.weights()[k];
    }
    steps -= belief_.size();
    return entropy_of(shares, [](const auto& entry) { return entry.second; });
  }

  void settle(int action, double value) {
    ActionEstimate& estimate = estimates_[action];
    if (estimate.n > 0 && value <= estimate.q) return;
    estimate.q = value;
    estimate.n = belief_.size();
  }

  bool has_learned_ = false;
  LeafCells<Model> cells_;
  SavingIndex<Model> by_rest_;
  SavingIndex<Model> by_chance_;
  SavingIndex<Model> by_sight_;
  SavingIndex<Model>* index_ = nullptr;  // the best one; null if there are no ways
  double seen_ = 0;
  // Of the last decision:
  SampledBelief<Model> belief_;
  double taken_ = 0;  // steps of the model
  double resting_ = 0;
  List<Found> found_;
  Estimates estimates_;
};

}
