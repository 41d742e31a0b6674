// What options earn from each of some states, and what a robot earns that takes the best of them for given weights of the
// states.
//
// Options whose changes do not touch each other follow one another where they still earn something, those with the highest income first. Where an option
// may end the mission, what follows counts as far as the mission goes on, since its end is always known. Nothing else
// that is observed on the way counts.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
#include "aos/planning/options/later_costs.hpp"
#include "aos/planning/options/optimal_stopping.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/option_sequels.hpp"
#include "aos/planning/options/own_changes.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/values/leaf_cells.hpp"

namespace aos {

// A plan that tests before it takes one of some options, or none (test_plans.hpp).
struct TestPlan {
  Option way;  // the first action, and an option
  List<std::size_t> options;
  StoppingChoice as;  // one option
};

template <class Model>
class OptionGains {
 public:
  using State = typename Model::State;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  // Takes each option from each state: twice where there are `even` states of the same weight, and the oftener the more a state
  // weighs. What changes by itself touches nothing. Options for which there is no time earn nothing. Of the steps a share is kept for
  // trying later which options can follow another.
  void measure(const auto& library, const SampledBelief<Model>& belief, double even, const OwnChanges<Model>& changes, const LaterCosts<Model>& later, double& steps, Sampler& random) {
    const List<State>& states = belief.states();
    *this = {};
    states_ = states.size();
    before_.resize(library.cells().size());
    after_.resize(before_.size());
    List<int> tries;  // by state
    for (const double weight : belief.weights()) tries.push_back(std::max<int>(least_tries, std::lround(least_tries * even * weight)));
    const int all_tries = std::accumulate(tries.begin(), tries.end(), 0);
    for (const Option& way : library.options()) {
      const List<double> none(states_);
      const auto length = static_cast<double>(way.size());
      KnownOption& option = options_.emplace_back(KnownOption{{none, none, std::pow(Model::discount, length), length}, way, none, std::vector<bool>(before_.size())});
      if (library.clock().is_over()) continue;
      for (std::size_t k = 0; k < states_; ++k) take(option, k, states[k], tries[k], later, library, random);
      steps -= all_tries * (static_cast<double>(way.size()) + LaterCosts<Model>::steps_of_looking);
      option.ends = option.ends && !option.earns_without_end;
      for (std::size_t i = 0; i < before_.size(); ++i) option.changed[i] = option.changed[i] && !changes.is_worlds(i);
    }
    used_.assign(size(), false);
    note_touches();
    // Where conditions are counted, an option earns by what others have done before it.
    sequels_.begin(options_, states, library.retries(), library.clock(), library.counts() ? 0 : share_of_sequels * steps, random);
  }

  // Lets the mission be over after so many steps, whatever the robot does: what no longer fits earns nothing.
  void end_after(double steps) { lasts_ = steps; }
  double lasts() const { return lasts_; }
  // What the best options earn less for having lost so many steps.
  double lost_by(double steps, const StateWeights& weights) const {
    if (!std::isfinite(lasts_)) return 0;
    support_of(weights);
    const double whole = best_of_support(none, lasts_);
    support_of(weights);
    return std::max(whole - best_of_support(none, lasts_ - steps), 0.0);
  }

  // Lets plans count as options do, in place of those before. For the options `weighed` it is known whether a test before them is worth it.
  void take_plans(List<TestPlan> plans, const List<std::size_t>& weighed) {
    const std::size_t options = size() - plans_.size();
    plans_ = std::move(plans);
    options_.resize(options);
    for (KnownOption& option : options_) option.is_tested = false;
    for (const std::size_t o : weighed) {
      if (o < options) options_[o].is_tested = true;
    }
    for (const auto& [way, of, as] : plans_) {
      KnownOption plan{as, way, {}, std::vector<bool>(before_.size())};
      plan.is_tested = true;
      for (const std::size_t o : of) {
        used_[o] = true;
        for (std::size_t i = 0; i < before_.size(); ++i) plan.changed[i] = plan.changed[i] || options_[o].changed[i];
      }
      options_.push_back(std::move(plan));
    }
    used_.resize(size());
    note_touches();
  }
  // Whether a plan goes elsewhere and tests there.
  bool is_trip(std::size_t option) const { return is_plan(option) && way(option).size() < way(tried(option)).size(); }
  // The plan that goes where an option does, and tests there; without one the option itself.
  std::size_t with_tests_there(std::size_t option) const {
    const Option there(way(option).begin(), way(option).end() - 1);
    const auto place = std::ranges::find(plans_, there, &TestPlan::way);
    return place != plans_.end() ? size() - plans_.size() + (place - plans_.begin()) : option;
  }
  bool is_plan(std::size_t option) const { return option + plans_.size() >= size(); }
  const Option& way(std::size_t option) const { return options_[option].way; }
  double length(std::size_t option) const { return options_[option].steps; }
  bool ends(std::size_t option) const { return options_[option].ends; }
  double earned_in(std::size_t option, std::size_t state) const { return options_[option].earned[state]; }
  double goes_on_in(std::size_t option, std::size_t state) const { return options_[option].goes_on[state]; }
  // Whether both change the same variable, but for what `all` options change.
  bool touch(std::size_t option, std::size_t other, const List<std::size_t>* all = nullptr) const {
    for (std::size_t i = 0; i < before_.size(); ++i) {
      const auto changes = [&](std::size_t o) { return options_[o].changed[i]; };
      if (changes(option) && changes(other) && !(all != nullptr && std::ranges::all_of(*all, changes))) return true;
    }
    return option == other;
  }

  // The steps that are kept for that and are not taken yet.
  double kept_steps() const { return sequels_.left(); }

  std::size_t size() const { return options_.size(); }
  double discount(std::size_t option) const { return options_[option].discount; }
  double earned(std::size_t option, const StateWeights& weights) const {
    return std::inner_product(weights.begin(), weights.end(), options_[option].earned.begin(), 0.0);
  }
  // The error of what an option earns that is no plan: few tries were made, and a way that was found by conditions may be too long.
  double error(std::size_t option, const StateWeights& weights) const {
    double squares = 0;
    for (std::size_t k = 0; k < states_ && !is_plan(option); ++k) squares += weights[k] * weights[k] * options_[option].errors[k];
    return std::sqrt(squares);
  }
  // Whether the option was among the best ones of a call since the last measurement.
  bool is_used(std::size_t option) const { return used_[option]; }

  // What the best options earn. What cannot follow the option `before` is left out.
  double best(const StateWeights& weights, std::size_t before = none) const {
    support_of(weights);
    return best_of_support(before, lasts_);
  }
  // The same where the state is seen.
  double best_in(std::size_t state, std::size_t before = none) const {
    support_.assign(1, {state, 1.0});
    return best_of_support(before, lasts_);
  }
  // How many steps the best options take.
  double steps_of_best(const StateWeights& weights) const {
    best(weights);
    return std::accumulate(chosen_.begin(), chosen_.end(), 0.0, [this](double steps, std::size_t o) { return steps + length(o); });
  }
  // What is lost by not seeing the state by options that were not weighed against tests before them.
  double untested_regret(const StateWeights& weights) const {
    const std::vector<bool> used = used_;
    double seen = 0;
    for (std::size_t k = 0; k < states_; ++k) {
      support_.assign(1, {k, 1.0});
      seen += weights[k] * best_of_support(none, lasts_, true);
    }
    support_of(weights);
    const double lost = seen - best_of_support(none, lasts_, true);
    used_ = used;
    return std::max(lost, 0.0);
  }
  // The option that `best_in` has found best, if it is only one, or the mission is to end by it: then others follow only where it
  // fails. Else none.
  std::size_t only_one() const {
    if (chosen_.empty()) return none;
    return chosen_.size() == 1 || ends(chosen_.front()) ? chosen_.front() : none;
  }
  // The weights of the states after an option, as far as the mission goes on.
  StateWeights after(std::size_t option, StateWeights weights) const {
    for (std::size_t k = 0; k < states_; ++k) weights[k] *= options_[option].goes_on[k];
    return weights;
  }

 private:
  static constexpr int least_tries = 2;  // of each option from each state
  static constexpr double share_of_sequels = 0.2;  // of the steps that are left
  // Of what a way costs that was found by conditions, as an error: towers were built for 15 % less (docs/lab/values.md).
  static constexpr double share_of_length = 0.25;
  static constexpr int max_ends = 4;  // options one after the other that may end the mission
  static constexpr double negligible = 1e-6;

  struct Weighted {
    std::size_t state;
    double weight;
  };
  struct Candidate {
    std::size_t option;
    double income;
    double earned;
  };

  void take(KnownOption& option, std::size_t k, const State& start, int tries, const LaterCosts<Model>& later, const auto& library, Sampler& random) {
    library.cells().write(start, before_.data());
    SampleMean earned;
    double last = 0;
    for (int i = 0; i < tries; ++i) {
      State state = start;
      const OptionOutcome outcome = taken_option<Model>(option.way, state, random, library.retries());
      earned.add(outcome.earned + later.of(option.way.size(), start, state, random));
      last += outcome.last / tries;
      option.goes_on[k] += outcome.goes_on / tries;
      if (outcome.goes_on == 0) option.ends = true;
      else if (outcome.earned > 0) option.earns_without_end = true;
      if (are_alike<Model>(start, state)) continue;
      library.cells().write(state, after_.data());
      for (std::size_t i = 0; i < before_.size(); ++i) {
        if (before_[i] != after_[i]) option.changed[i] = true;
      }
    }
    option.earned[k] = earned.mean();
    const double of_length = library.counts() ? share_of_length * std::max(last - earned.mean(), 0.0) : 0;
    option.errors[k] = earned.error() * earned.error() + of_length * of_length;
  }

  void support_of(const StateWeights& weights) const {
    support_.clear();
    for (std::size_t k = 0; k < states_; ++k) {
      if (weights[k] > negligible) support_.push_back({k, weights[k]});
    }
  }

  // What the best options earn in so many steps; an option that may end the mission takes its share from the weights.
  double best_of_support(std::size_t before, double left, bool is_untested = false) const {
    candidates_.clear();
    for (std::size_t o = 0; o < size(); ++o) {
      if (is_untested && options_[o].is_tested) continue;
      if (before != none && cannot_follow(o, before)) continue;
      const double earned = earned_by(o);
      if (earned > 0) candidates_.push_back({o, income<Model>(earned, length(o)), earned});
    }
    sort_stably(candidates_, [](const Candidate& one, const Candidate& other) { return one.income > other.income; });
    double sum = 0;
    double discount = 1;
    if (before != none) left -= length(before);
    chosen_.clear();
    for (const Candidate& candidate : candidates_) {
      if (ends(candidate.option) || length(candidate.option) > left) continue;
      if (std::ranges::any_of(chosen_, [&](std::size_t o) { return cannot_follow(candidate.option, o); })) continue;
      chosen_.push_back(candidate.option);
      used_[candidate.option] = true;
      sum += discount * candidate.earned;
      discount *= options_[candidate.option].discount;
      left -= length(candidate.option);
    }
    return sum + discount * best_end(left);
  }

  // What is earned by options that may end the mission, one after the other while it goes on.
  double best_end(double left) const {
    double sum = 0;
    double discount = 1;
    for (int i = 0; i < max_ends; ++i) {
      std::size_t best = none;
      double most = 0;
      for (const Candidate& candidate : candidates_) {
        if (!ends(candidate.option) || length(candidate.option) > left) continue;
        const double earned = i == 0 ? candidate.earned : earned_by(candidate.option);
        if (earned <= most) continue;
        most = earned;
        best = candidate.option;
      }
      if (best == none) break;
      used_[best] = true;
      chosen_.push_back(best);
      sum += discount * most;
      discount *= options_[best].discount;
      left -= length(best);
      for (Weighted& weighted : support_) weighted.weight *= options_[best].goes_on[weighted.state];
    }
    return sum;
  }

  double earned_by(std::size_t option) const {
    const double* const earned = options_[option].earned.data();
    double sum = 0;
    for (const auto& [state, weight] : support_) sum += weight * earned[state];
    return sum;
  }

  void note_touches() {
    touches_.assign(size() * size(), false);
    for (std::size_t o = 0; o < size(); ++o) {
      for (std::size_t other = 0; other < size(); ++other) touches_[o * size() + other] = touch(o, other);
    }
  }
  // An option that fails to end the mission leaves the others as they were.
  bool cannot_follow(std::size_t option, std::size_t before) const {
    return option == before || (!ends(before) && (touches_[option * size() + before] || !sequels_.can_follow(tried(option), tried(before))));
  }
  // Of a plan its first option is tried.
  std::size_t tried(std::size_t option) const { return is_plan(option) ? plans_[option + plans_.size() - size()].options.front() : option; }

  List<KnownOption> options_;  // the plans come last
  List<TestPlan> plans_;
  std::size_t states_ = 0;
  double lasts_ = std::numeric_limits<double>::infinity();  // steps
  std::vector<bool> touches_;  // [option * options + option]
  List<std::uint64_t> before_;
  List<std::uint64_t> after_;
  mutable OptionSequels<Model> sequels_;
  mutable std::vector<bool> used_;
  mutable List<Weighted> support_;
  mutable List<Candidate> candidates_;
  mutable List<std::size_t> chosen_;
};

}
