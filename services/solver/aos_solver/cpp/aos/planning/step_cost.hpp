// What a step by the documents' code costs beside a step by a list of outcomes, counted and not timed.
#pragma once

#include <chrono>

#include "aos/draws/directed.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"

namespace aos {

class CountedDraws final : public DirectedDraws {
 public:
  explicit CountedDraws(std::uint64_t seed) : random_(seed) { report_to(&ignored_numbers); }

  int choose(const double* weights, int count, double total) override {
    takes_sensing();
    cost_ += count > 2 ? per_choice + per_weight * count : per_flag;
    return random_.choose(weights, count, total);
  }
  double uniform() override {
    takes_sensing();
    cost_ += per_number;
    return random_.uniform();
  }
  int below(int bound) { return random_.below(bound); }
  double cost() const { return cost_; }

 private:
  static constexpr double per_flag = 12;
  static constexpr double per_choice = 100;  // of weights that code computes and keeps in memory of their own
  static constexpr double per_weight = 2.5;
  static constexpr double per_number = 25;

  Sampler random_;
  double cost_ = 0;
};

// The mean cost of a step in operations, from walks of random actions from initial states. Steps that write a text cost
// most, by the draws that the text is made of.
template <class Model>
Operations cost_of_step() {
  constexpr int walks = 16;
  constexpr int longest = 16;
  constexpr double per_step = 25;
  constexpr double per_text = 4;  // times as much as its draws
  if (Model::action_count() == 0) return 0;
  CountedDraws draws{1};
  Sampler starts{1};
  int steps = 0;
  double cost = 0;
  try {
    for (int walk = 0; walk < walks; ++walk) {
      typename Model::State state{};
      Model::initial(state, starts);
      for (int i = 0; i < longest && Model::ending(state) == Ending::running; ++i, ++steps) {
        const double before = draws.cost();
        const Step step = Model::step(state, draws.below(Model::action_count()), draws);
        const bool is_text = step.observation < default_observation;
        cost += per_step + (is_text ? per_text : 1) * (draws.cost() - before);
      }
    }
  } catch (...) {
    blame::at(0);
  }
  return static_cast<Operations>(steps == 0 ? per_step : cost / steps);
}

// How many steps of the model a planner may take that counts its work by them. What a step costs is counted at first. With a
// budget in time it is measured: a planner notes what it has taken.
template <class Model>
class AffordableSteps {
 public:
  // At most so many steps as are counted, or, where `as_measured`, all that there was time for before.
  double of(Budget budget, int horizon, bool as_measured = false) {
    if (budget.simulations > 0) return std::max(static_cast<double>(budget.simulations) * horizon, least);
    if (step_cost_ == 0) step_cost_ = std::max(cost_of_step<Model>(), operations_of_step);
    const double affordable = budget.seconds * operations_of_second / step_cost_;
    const double measured = seconds_ > 0 ? budget.seconds * steps_ / seconds_ : affordable;
    return std::max(as_measured ? measured : std::min(affordable, measured), least_in_time);
  }
  // So many steps took so long. Later ones count more.
  void note(double steps, std::chrono::duration<double> time) {
    steps_ = kept * steps_ + steps;
    seconds_ = kept * seconds_ + time.count();
  }

 private:
  static constexpr double least = 100'000;
  static constexpr double least_in_time = 10'000;
  static constexpr double kept = 0.8;

  Operations step_cost_ = 0;  // 0: not known yet
  double steps_ = 0;          // of some decisions, and the time that they took
  double seconds_ = 0;
};

}
