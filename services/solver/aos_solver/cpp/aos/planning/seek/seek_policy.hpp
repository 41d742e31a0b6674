// Looks for one thing among many places: goes where a nat is cheapest, looks there, and stops in time.
//
// States of the belief stand for it, one for all that differ by what runs down alone. From them the places are found that moves
// lead to (seek_places.hpp). In each place each action that tells something is a test. A state wins by a test if the best end after
// it returns more than without it. States that win by the same tests are a class, and tests tell of the class. The policy takes the
// test, with the way to it, that tells most for what it costs, as long as the best end can be had after it. Missions by this
// policy, whose true state the code of the model steps, tell what it returns.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/base/statistics.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/values/running_down.hpp"
#include "aos/planning/seek/seek_places.hpp"

namespace aos {

// What a policy returns, with its standard error, and the action that it takes first.
struct Sought {
  int action = -1;  // none
  double returned = 0;
  double error = 0;
  int missions = 0;  // that were played
};

template <class Model>
class SeekPolicy {
 public:
  using State = typename Model::State;

  // Finds the policy for a belief and plays missions by it, in about so many steps of the model. None where no test wins, or where half of
  // the steps do not do to look round.
  Sought find(const Belief<Model>& belief, int horizon, const BarredActions& barred, double affordable, Sampler& random) {
    horizon_ = horizon;
    steps_ = affordable;
    if (!is_prepared_) running_down_.find(belief, random);
    is_prepared_ = true;
    belief_.draw_alike(belief, most_states, [&](const State& state) { return running_down_.all_else_of(state); }, random);
    returned_at_once_ = 0;
    if (!places_.explore(belief_, running_down_, barred, steps_, random)) return {};
    find_ends(random);
    if (!find_wins(random)) return {};
    find_classes();
    const int first = first_action(random);
    if (first < 0) return {};
    SampleMean returned;
    steps_ = std::max(steps_, affordable / 2);
    for (int mission = 0; mission < most_missions && (mission < fewest_missions || steps_ > 0); ++mission) {
      const std::size_t k = random.choose(belief_.weights().data(), belief_.size(), 1.0);
      returned.add(played(k, random));
    }
    return {first, returned.mean(), returned.error(), static_cast<int>(returned.count())};
  }
  // What the best end at once returns on average; 0 without an end.
  double returned_at_once() const { return returned_at_once_; }
  void start_over() { is_prepared_ = false; }

 private:
  using Places = SeekPlaces<Model>;
  using Test = typename Places::Test;
  using End = typename Places::End;

  static constexpr std::size_t most_states = 160;
  static constexpr std::size_t most_ends = 3;
  static constexpr int fewest_missions = 16;
  static constexpr int most_missions = 64;
  static constexpr double least_information = 1e-4;

  // --- ends and wins

  // Keeps the ends that return most on average.
  void find_ends(Sampler& random) {
    List<End>& ends = places_.ends();
    std::ranges::stable_sort(ends, [](const End& one, const End& other) { return one.reward > other.reward; });
    if (ends.size() > most_ends) ends.resize(most_ends);
    returned_at_once_ = belief_.mean([&](std::size_t k) { return ended(0, belief_.states()[k], random).returned; });
  }

  struct Ended {
    int action = -1;  // the first one
    double returned = 0;
    bool fails = false;
  };
  // What the best end returns from a state at a place; 0 without an end.
  Ended ended(std::uint32_t place, const State& start, Sampler random) {
    Ended best;
    for (const End& end : places_.ends()) {
      if (places_.ways_from(place)[end.place].distance == Places::nowhere) continue;
      State state = start;
      const List<int> actions = places_.way(place, end.place, end.action);
      const double returned = taken(state, actions, random);
      if (best.action >= 0 && returned <= best.returned) continue;
      best = {actions.front(), returned, Model::ending(state) == Ending::failure};
    }
    return best;
  }
  double taken(State& state, const List<int>& actions, Sampler& random) {
    const auto take = [&](std::size_t step) {
      --steps_;
      return Model::step(state, actions[step], random).reward;
    };
    return earned_in<Model>(actions.size(), state, take).sum;
  }

  // Notes for each state by which tests it wins. Returns whether any does.
  bool find_wins(Sampler& random) {
    wins_.assign(belief_.size(), 0);
    stake_ = 0;
    double wins = 0;
    for (std::size_t t = 0; t < places_.tests().size(); ++t) {
      const Test& test = places_.tests()[t];
      const List<State>& before = places_.places()[test.place].states;
      for (std::size_t k = 0; k < before.size(); ++k) {
        const State& after = places_.after(t)[k];
        if (!running_down_.differ(after, before[k])) continue;
        const bool goes_on = Model::ending(after) == Ending::running;
        State last = before[k];
        Sampler luck{random.bits()};
        const double reward = goes_on ? test.reward : Model::step(last, test.action, luck).reward;
        const double now = ended(test.place, before[k], random).returned;
        const double then = reward + (goes_on ? Model::discount * ended(test.place, after, random).returned : 0);
        if (then <= std::max(now, 0.0)) continue;
        wins_[k] = mixed(wins_[k], t + 1);
        stake_ += then - now;
        ++wins;
      }
    }
    if (wins > 0) stake_ /= wins;
    return wins > 0;
  }

  void find_classes() {
    std::map<std::uint64_t, std::size_t> numbers;
    class_of_.clear();
    for (const std::uint64_t key : wins_) class_of_.push_back(numbers.emplace(key, numbers.size()).first->second);
    classes_ = numbers.size();
    prior_.assign(classes_, 0);
    for (std::size_t k = 0; k < belief_.size(); ++k) prior_[class_of_[k]] += belief_.weights()[k];
    for (Test& test : places_.tests()) {
      test.odds.assign(classes_ * test.outcomes, 0);
      for (std::size_t k = 0; k < belief_.size(); ++k) {
        const double share = belief_.weights()[k] / prior_[class_of_[k]];
        for (std::size_t o = 0; o < test.outcomes; ++o) test.odds[class_of_[k] * test.outcomes + o] += share * test.own[k * test.outcomes + o];
      }
      for (std::size_t z = 0; z < classes_; ++z) {
        test.doubts.push_back(entropy_of(std::span{&test.odds[z * test.outcomes], test.outcomes}));
      }
    }
  }

  // --- the policy

  double information(const Test& test, const List<double>& weights) {
    seen_.assign(test.outcomes, 0);
    double doubt = 0;
    for (std::size_t z = 0; z < classes_; ++z) {
      doubt += weights[z] * test.doubts[z];
      for (std::size_t o = 0; o < test.outcomes; ++o) seen_[o] += weights[z] * test.odds[z * test.outcomes + o];
    }
    double sum = -doubt;
    for (const double p : seen_) sum += share_of_entropy(p);
    return sum;
  }

  // The test whose nat is cheapest among those after which the best end does not fail; null if there is none.
  const Test* best_test(std::uint32_t place, const List<double>& weights, const State& state, Sampler& random) {
    const auto& ways = places_.ways_from(place);
    ranked_.clear();
    for (const Test& test : places_.tests()) {
      const auto& [distance, before, by, paid] = ways[test.place];
      if (distance == Places::nowhere) continue;
      const double told = information(test, weights);
      if (told < least_information) continue;
      const double later = std::pow(Model::discount, distance);
      const double cost = (1 - later * Model::discount) * stake_ - paid - later * test.reward;
      ranked_.emplace_back(told / std::max(cost, 1e-9), &test);
    }
    steps_ -= static_cast<double>(places_.tests().size() * classes_) / 20;
    const std::size_t tried = std::min<std::size_t>(ranked_.size(), 4);
    std::partial_sort(ranked_.begin(), ranked_.begin() + tried, ranked_.end(),
                      [](const auto& one, const auto& other) { return one.first > other.first; });
    for (std::size_t i = 0; i < tried; ++i) {
      const Test& test = *ranked_[i].second;
      State then = state;
      taken(then, places_.way(place, test.place, test.action), random);
      const bool is_asked = Model::ending(then) == Ending::running && !places_.ends().empty();
      if (is_asked ? !ended(test.place, then, random).fails : Model::ending(then) != Ending::failure) return &test;
    }
    return nullptr;
  }

  const State& any_state() const { return belief_.states()[belief_.size() / 2]; }

  int first_action(Sampler& random) {
    const Test* const test = best_test(0, prior_, any_state(), random);
    if (test == nullptr) return ended(0, any_state(), random).action;
    return places_.way(0, test->place, test->action).front();
  }

  double played(std::size_t k, Sampler& random) {
    State state = belief_.states()[k];
    List<double> weights = prior_;
    std::uint32_t place = 0;
    Earned<Model> earned;
    const auto end_now = [&] { return earned.sum + earned.discount * ended(place, state, random).returned; };
    for (int left = horizon_; left > 0;) {
      const Test* const test = best_test(place, weights, state, random);
      if (test == nullptr) return end_now();
      const List<int> actions = places_.way(place, test->place, test->action);
      State before = state;
      for (const int action : actions) {
        before = state;
        earned.add(Model::step(state, action, random).reward);
        --steps_;
        --left;
        if (Model::ending(state) != Ending::running) return earned.sum;
      }
      place = test->place;
      if (running_down_.differ(state, before)) return end_now();
      const double* const own = &test->own[k * test->outcomes];
      const std::size_t seen = random.choose(own, test->outcomes, 1.0);
      double all = 0;
      for (std::size_t z = 0; z < classes_; ++z) all += weights[z] *= test->odds[z * test->outcomes + seen];
      if (!(all > 0)) return end_now();
      for (double& weight : weights) weight /= all;
    }
    return earned.sum;
  }

  bool is_prepared_ = false;
  int horizon_ = 1;
  double steps_ = 0;
  SampledBelief<Model> belief_;
  RunningDown<Model> running_down_;
  Places places_;
  List<std::uint64_t> wins_;    // by state
  List<std::size_t> class_of_;  // by state
  std::size_t classes_ = 0;
  List<double> prior_;  // by class
  double stake_ = 0;           // what a win is worth, on average
  double returned_at_once_ = 0;
  List<double> seen_;
  List<std::pair<double, const Test*>> ranked_;
};

}
