// What options earn from each of some states, and what a robot earns that takes the best of them for given weights of the
// states.
//
// Options whose changes do not touch each other follow one another where they still earn something, those with the highest income first. Where an option
// may end the mission, what follows counts as far as the mission goes on, since its end is always known. Nothing else
// that is observed on the way counts.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/statistics.hpp"
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
  void measure(const auto& library, const SampledBelief<Model>& belief, double even, const OwnChanges<Model>& changes, double& steps, Sampler& random) {
    const List<State>& states = belief.states();
    const List<Option>& options = library.options();
    const LeafCells<Model>& cells = library.cells();
    *this = {};
    ways_ = options;
    is_tested_.assign(options.size(), false);
    retries_ = library.retries();
    states_ = states.size();
    earned_.assign(options.size() * states_, 0);
    goes_on_.assign(options.size() * states_, 0);
    errors_.assign(options.size() * states_, 0);
    changed_.assign(options.size(), std::vector<bool>(cells.size()));
    ends_.assign(options.size(), false);
    earns_without_end_.assign(options.size(), false);
    used_.assign(options.size(), false);
    before_.resize(cells.size());
    after_.resize(cells.size());
    of_length_ = library.counts() ? share_of_length : 0;
    List<int> tries;  // by state
    for (const double weight : belief.weights()) tries.push_back(std::max<int>(least_tries, std::lround(least_tries * even * weight)));
    const int all_tries = std::accumulate(tries.begin(), tries.end(), 0);
    for (std::size_t o = 0; o < options.size(); ++o) {
      discounts_.push_back(std::pow(Model::discount, options[o].size()));
      lengths_.push_back(static_cast<double>(options[o].size()));
      if (library.clock().is_over()) continue;
      for (std::size_t k = 0; k < states_; ++k) take(o, k, states[k], tries[k], cells, random);
      steps -= all_tries * static_cast<double>(options[o].size());
    }
    for (std::size_t o = 0; o < options.size(); ++o) ends_[o] = ends_[o] && !earns_without_end_[o];
    for (auto& changed : changed_) {
      for (std::size_t i = 0; i < cells.size(); ++i) changed[i] = changed[i] && !changes.is_worlds(i);
    }
    note_touches();
    // Where conditions are counted, an option earns by what others have done before it.
    sequels_.begin(options, states, earned_, retries_, library.clock(), library.counts() ? 0 : share_of_sequels * steps, random);
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
    is_tested_.assign(options, false);
    for (const std::size_t o : weighed) is_tested_[o] = true;
    ways_.resize(options);
    discounts_.resize(options);
    lengths_.resize(options);
    changed_.resize(options);
    earned_.resize(options * states_);
    goes_on_.resize(options * states_);
    for (const auto& [way, of, as] : plans_) {
      ways_.push_back(way);
      discounts_.push_back(as.discount);
      lengths_.push_back(as.steps);
      earned_.insert(earned_.end(), as.earned.begin(), as.earned.end());
      goes_on_.insert(goes_on_.end(), as.goes_on.begin(), as.goes_on.end());
      std::vector<bool> changed(changed_[of.front()].size());
      for (const std::size_t o : of) {
        used_[o] = true;
        for (std::size_t i = 0; i < changed.size(); ++i) changed[i] = changed[i] || changed_[o][i];
      }
      changed_.push_back(std::move(changed));
    }
    ends_.resize(size());
    used_.resize(size());
    is_tested_.resize(size(), true);
    note_touches();
  }
  // Whether a plan goes elsewhere and tests there.
  bool is_trip(std::size_t option) const { return is_plan(option) && ways_[option].size() < ways_[tried(option)].size(); }
  // The plan that goes where an option does, and tests there; without one the option itself.
  std::size_t with_tests_there(std::size_t option) const {
    const Option there(ways_[option].begin(), ways_[option].end() - 1);
    const auto place = std::ranges::find(plans_, there, &TestPlan::way);
    return place != plans_.end() ? size() - plans_.size() + (place - plans_.begin()) : option;
  }
  bool is_plan(std::size_t option) const { return option + plans_.size() >= size(); }
  const Option& way(std::size_t option) const { return ways_[option]; }
  double length(std::size_t option) const { return lengths_[option]; }
  bool ends(std::size_t option) const { return ends_[option]; }
  double earned_in(std::size_t option, std::size_t state) const { return earned_[option * states_ + state]; }
  double goes_on_in(std::size_t option, std::size_t state) const { return goes_on_[option * states_ + state]; }
  // Whether both change the same variable, but for what `all` options change.
  bool touch(std::size_t option, std::size_t other, const List<std::size_t>* all = nullptr) const {
    for (std::size_t i = 0; i < changed_[option].size(); ++i) {
      const auto changes = [&](std::size_t o) { return changed_[o][i]; };
      if (changes(option) && changes(other) && !(all != nullptr && std::ranges::all_of(*all, changes))) return true;
    }
    return option == other;
  }

  // The steps that are kept for that and are not taken yet.
  double kept_steps() const { return sequels_.left(); }

  std::size_t size() const { return discounts_.size(); }
  double discount(std::size_t option) const { return discounts_[option]; }
  double earned(std::size_t option, const StateWeights& weights) const {
    double sum = 0;
    for (std::size_t k = 0; k < states_; ++k) sum += weights[k] * earned_[option * states_ + k];
    return sum;
  }
  // The error of what an option earns that is no plan: few tries were made, and a way that was found by conditions may be too long.
  double error(std::size_t option, const StateWeights& weights) const {
    double squares = 0;
    for (std::size_t k = 0; k < states_ && !is_plan(option); ++k) squares += weights[k] * weights[k] * errors_[option * states_ + k];
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
    return std::accumulate(chosen_.begin(), chosen_.end(), 0.0, [this](double steps, std::size_t o) { return steps + lengths_[o]; });
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
    return chosen_.size() == 1 || ends_[chosen_.front()] ? chosen_.front() : none;
  }
  // The weights of the states after an option, as far as the mission goes on.
  StateWeights after(std::size_t option, StateWeights weights) const {
    for (std::size_t k = 0; k < states_; ++k) weights[k] *= goes_on_[option * states_ + k];
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

  void take(std::size_t option, std::size_t k, const State& start, int tries, const LeafCells<Model>& cells, Sampler& random) {
    cells.write(start, before_.data());
    SampleMean earned;
    double last = 0;
    for (int i = 0; i < tries; ++i) {
      State state = start;
      const OptionOutcome outcome = taken_option<Model>(ways_[option], state, random, retries_);
      earned.add(outcome.earned);
      last += outcome.last / tries;
      goes_on_[option * states_ + k] += outcome.goes_on / tries;
      if (outcome.goes_on == 0) ends_[option] = true;
      else if (outcome.earned > 0) earns_without_end_[option] = true;
      if (are_alike<Model>(start, state)) continue;
      cells.write(state, after_.data());
      for (std::size_t i = 0; i < cells.size(); ++i) {
        if (before_[i] != after_[i]) changed_[option][i] = true;
      }
    }
    earned_[option * states_ + k] = earned.mean();
    const double of_length = of_length_ * std::max(last - earned.mean(), 0.0);
    errors_[option * states_ + k] = earned.error() * earned.error() + of_length * of_length;
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
      if (is_untested && is_tested_[o]) continue;
      if (before != none && cannot_follow(o, before)) continue;
      const double earned = earned_by(o);
      if (earned > 0) candidates_.push_back({o, income<Model>(earned, lengths_[o]), earned});
    }
    sort_stably(candidates_, [](const Candidate& one, const Candidate& other) { return one.income > other.income; });
    double sum = 0;
    double discount = 1;
    if (before != none) left -= lengths_[before];
    chosen_.clear();
    for (const Candidate& candidate : candidates_) {
      if (ends_[candidate.option] || lengths_[candidate.option] > left) continue;
      if (std::ranges::any_of(chosen_, [&](std::size_t o) { return cannot_follow(candidate.option, o); })) continue;
      chosen_.push_back(candidate.option);
      used_[candidate.option] = true;
      sum += discount * candidate.earned;
      discount *= discounts_[candidate.option];
      left -= lengths_[candidate.option];
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
        if (!ends_[candidate.option] || lengths_[candidate.option] > left) continue;
        const double earned = i == 0 ? candidate.earned : earned_by(candidate.option);
        if (earned <= most) continue;
        most = earned;
        best = candidate.option;
      }
      if (best == none) break;
      used_[best] = true;
      chosen_.push_back(best);
      sum += discount * most;
      discount *= discounts_[best];
      left -= lengths_[best];
      for (Weighted& weighted : support_) weighted.weight *= goes_on_[best * states_ + weighted.state];
    }
    return sum;
  }

  double earned_by(std::size_t option) const {
    const double* const earned = &earned_[option * states_];
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
    return option == before || (!ends_[before] && (touches_[option * size() + before] || !sequels_.can_follow(tried(option), tried(before))));
  }
  // Of a plan its first option is tried.
  std::size_t tried(std::size_t option) const { return is_plan(option) ? plans_[option + plans_.size() - size()].options.front() : option; }

  List<Option> ways_;  // the plans come last
  List<TestPlan> plans_;
  std::size_t states_ = 0;
  double lasts_ = std::numeric_limits<double>::infinity();  // steps
  const RunningDown<Model>* retries_ = nullptr;  // actions that change nothing else are taken again
  List<double> earned_;   // [option * states + state]
  List<double> goes_on_;  // [option * states + state]
  List<double> errors_;   // [option * states + state], squared
  double of_length_ = 0;
  List<double> discounts_;
  List<double> lengths_;  // in steps
  std::vector<bool> ends_;  // in some state, and earns nothing where it does not
  std::vector<bool> earns_without_end_;
  std::vector<bool> is_tested_;  // a plan, or an option that was weighed against tests
  List<std::vector<bool>> changed_;  // [option][variable]
  std::vector<bool> touches_;               // [option * options + option]
  List<std::uint64_t> before_;
  List<std::uint64_t> after_;
  mutable OptionSequels<Model> sequels_;
  mutable std::vector<bool> used_;
  mutable List<Weighted> support_;
  mutable List<Candidate> candidates_;
  mutable List<std::size_t> chosen_;
};

}
