// What is at stake in a belief of a few states: what the best options earn where each state is seen, and how much of it is
// lost where it is not, which is the regret of not knowing it.
#pragma once

#include "aos/base/statistics.hpp"
#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/repeated_observation.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

// An action, what it promises, and why.
struct OptionCandidate {
  int action;
  double value;
  double discount;  // of what comes after it
  const char* reason;
  List<double> avoided{};  // of each likely option: what is not lost by it, since the observation tells of it
  List<int> way{};         // by which it observes
  double spared = 0;              // of the regret, by what is observed
  List<List<StepReports>> reports{};  // of a move that goes on for certain: [step][state]
  double goes_on = 1;  // the probability that the mission does
  double error = 0;    // of the value, beside that few states are drawn
};

template <class Model>
class OptionRegret {
 public:
  struct Told {
    double regret = 0;
    List<double> avoided{};  // see OptionCandidate
  };

  OptionRegret(const SampledBelief<Model>& belief, const OptionGains<Model>& gains) : belief_(belief), gains_(gains) {}

  // Takes the belief and the gains as they are now.
  void begin() {
    seen_.clear();
    only_ways_.clear();
    likely_.clear();
    price_ = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < belief_.size(); ++k) {
      seen_.push_back(gains_.best_in(k));
      only_ways_.push_back(gains_.only_one());
    }
    value_seen_ = value_seen(belief_.weights());
    regret_ = after(belief_.weights());
  }
  // Lets a robot find out the state at this price for each nat, or only which way is best, so that it never loses more by not knowing it. What is
  // told by tests together counts then, where each alone leaves the best options what they are.
  void set_price(double price, bool of_ways) {
    if (price == price_ && of_ways == prices_ways_) return;
    price_ = price;
    prices_ways_ = of_ways;
    regret_ = after(belief_.weights());
  }
  // The same where options have been added that earn no more where the state is seen.
  void weigh_again() { regret_ = after(belief_.weights()); }
  // By state: the option that is best there, where no other one follows it.
  const List<std::size_t>& only_ways() const { return only_ways_; }
  // Whether the mission ends by the option that is best in a state, if it is the only one.
  bool ends(std::size_t state) const { return only_ways_[state] < gains_.size() && gains_.ends(only_ways_[state]); }
  // The options that may be taken next.
  void watch(List<std::size_t> likely) { likely_ = std::move(likely); }
  double value_seen(std::size_t state) const { return seen_[state]; }
  double value_seen() const { return value_seen_; }
  double value_seen(const StateWeights& weights) const { return std::inner_product(weights.begin(), weights.end(), seen_.begin(), 0.0); }
  double now() const { return regret_; }
  // The steps until a deadline, and what is earned less for having lost some of them.
  double lasts() const { return gains_.lasts(); }
  double lost_by(double steps) const { return gains_.lost_by(steps, belief_.weights()); }
  // The standard error of `value_seen`, since few states are drawn.
  double error() const {
    double squares = 0;
    double concentration = 0;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      squares += belief_.weights()[k] * (seen_[k] - value_seen_) * (seen_[k] - value_seen_);
      concentration += belief_.weights()[k] * belief_.weights()[k];
    }
    return std::sqrt(squares * concentration);
  }
  double after(const StateWeights& weights) const {
    const double blind = std::max(value_seen(weights) - gains_.best(weights), 0.0);
    return blind > 0 && std::isfinite(price_) ? std::min(blind, price_ * entropy_of(prices_ways_ ? by_way(weights) : weights)) : blind;
  }

  // The mean regret after an observation that is made so many times, from the weights `before`, and what it tells of each likely option.
  // Where these are too many to list, `see(k, weights)` draws from state k what is observed. `steps` is counted down.
  Told after(const RepeatedObservation& observation, int times, const StateWeights& before, double& steps, Sampler& random, auto&& see) const {
    Told told;
    for (const std::size_t option : likely_) told.avoided.push_back(-std::max(gains_.earned(option, before), 0.0));
    after_each(observation, times, before, random, see, [&](double probability, const StateWeights& weights) {
      told.regret += probability * after(weights);
      for (std::size_t i = 0; i < likely_.size(); ++i) told.avoided[i] += probability * std::max(gains_.earned(likely_[i], weights), 0.0);
      steps -= steps_of_best();
    });
    return told;
  }

 private:
  StateWeights by_way(const StateWeights& weights) const {
    StateWeights sums(gains_.size() + 1);  // the last one is that of states where nothing can be earned
    for (std::size_t k = 0; k < weights.size(); ++k) sums[std::min(only_ways_[k], gains_.size())] += weights[k];
    return sums;
  }
  // How many steps of the model take as long as to find the best options.
  double steps_of_best() const {
    constexpr double of_gain = 0.02;
    return of_gain * (gains_.size() * belief_.size());
  }
  const SampledBelief<Model>& belief_;
  const OptionGains<Model>& gains_;
  List<std::size_t> likely_;
  List<double> seen_;  // what the states are worth if they are seen
  List<std::size_t> only_ways_;
  double value_seen_ = 0;
  double regret_ = 0;
  double price_ = std::numeric_limits<double>::infinity();  // of a nat
  bool prices_ways_ = false;
};

}
