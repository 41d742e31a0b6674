// When to stop testing: one of several choices is made, or none, and tests tell which one. All that a few tests can report is gone through.
#pragma once

#include "aos/planning/options/sampled_belief.hpp"

namespace aos {

struct StoppingTest {
  int action;
  double reward;
  List<List<double>> likelihoods;  // [response][state]
  double information = 0;          // of the state, in nats
};

// A choice, or tests with the choice after them.
struct StoppingChoice {
  List<double> earned;   // by state
  List<double> goes_on;  // by state
  double discount;       // of what comes after it
  double steps;          // on average
};

struct StoppingPlan {
  double value;
  const StoppingTest* test;  // none where it is best to choose at once
  StoppingChoice as;
};

class OptimalStopping {
 public:
  // `rest` is earned after the choice, whatever it is, less `price` for each step until then.
  OptimalStopping(const List<StoppingChoice>& choices, const List<const StoppingTest*>& tests, double discount, double rest, double price = 0)
      : choices_(choices), tests_(tests), discount_(discount), rest_(rest), price_(price) {}

  // The best plan of so many tests; the weights may sum to less than 1. No test follows where to see the state is worth less.
  StoppingPlan plan(const StateWeights& weights, int most_tests) {
    ++plans_;
    const double mass = std::accumulate(weights.begin(), weights.end(), 0.0);
    StoppingPlan best{mass * rest_, nullptr, {List<double>(weights.size()), List<double>(weights.size(), 1.0), 1, 0}};
    List<double> seen(weights.size(), rest_);
    for (const StoppingChoice& choice : choices_) {
      const double rest = choice.discount * rest_ - choice.steps * price_;
      for (std::size_t k = 0; k < seen.size(); ++k) seen[k] = std::max(seen[k], choice.earned[k] + rest);
      const double value = mean(weights, choice.earned) + mass * rest;
      if (value > best.value) best = {value, nullptr, choice};
    }
    const double lost = mean(weights, seen) - best.value;
    for (const StoppingTest* test : tests_) {
      const double price = (1 - discount_) * std::max(rest_, 0.0) + price_ - test->reward;
      if (most_tests == 0 || lost <= price * mass) continue;
      StoppingPlan tested = after(*test, weights, mass, most_tests - 1);
      if (tested.value > best.value + least_gain * mass) best = std::move(tested);
    }
    return best;
  }
  // So far.
  std::size_t plans() const { return plans_; }

 private:
  static constexpr double least_gain = 1e-9;

  static double mean(const StateWeights& weights, const List<double>& values) { return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0); }

  StoppingPlan after(const StoppingTest& test, const StateWeights& weights, double mass, int most_tests) {
    StoppingPlan all{(test.reward - price_) * mass, &test, {List<double>(weights.size(), test.reward), List<double>(weights.size(), 1.0), 0, 1}};
    for (const auto& likelihoods : test.likelihoods) {
      StateWeights told = weights;
      for (std::size_t k = 0; k < told.size(); ++k) told[k] *= likelihoods[k];
      const auto [value, next, as] = plan(told, most_tests);
      const double share = std::accumulate(told.begin(), told.end(), 0.0) / mass;
      all.value += discount_ * value;
      all.as.discount += share * discount_ * as.discount;
      all.as.steps += share * as.steps;
      for (std::size_t k = 0; k < told.size(); ++k) {
        all.as.earned[k] += discount_ * likelihoods[k] * as.earned[k];
        all.as.goes_on[k] -= likelihoods[k] * (1 - as.goes_on[k]);
      }
    }
    return all;
  }

  const List<StoppingChoice>& choices_;
  const List<const StoppingTest*>& tests_;
  double discount_;
  double rest_;
  double price_;
  std::size_t plans_ = 0;
};

}
