// Decides where the states cannot be listed: which option to take, or what to find out before.
//
// A few states of the belief stand for it. Options are ways to what can be earned from one of them (option_search.hpp).
// What the best options earn by the weights of the states is what the robot earns if it observes nothing more. Where the
// state is seen they earn more, and the difference is the regret of not knowing it. So an observation is worth the regret
// that it takes away. The robot does what has the highest sum of what is earned on the way and what the seen states are worth
// after it, less the regret that is left. It may
//
//   take an option;
//   observe, once or several times in a row (blinkered value of information: Hay, Russell, Tolpin and Shimony, 2012);
//   move, and observe on the way or where it leads.
//
// Where some actions only observe, half of the regret counts, since more can be observed later.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/option_gains.hpp"
#include "aos/planning/option_library.hpp"
#include "aos/planning/option_moves.hpp"
#include "aos/planning/option_regret.hpp"
#include "aos/planning/option_search.hpp"
#include "aos/planning/option_tests.hpp"
#include "aos/planning/sampled_belief.hpp"
#include "aos/planning/step_cost.hpp"

namespace aos {

template <class Model>
class OptionPolicy {
 public:
  using State = typename Model::State;

  // Draws states and finds options. Returns why this policy cannot decide; empty if it can.
  std::string prepare(const Belief<Model>& belief, Budget budget, int horizon, Sampler random) {
    if (belief.probability_of(Ending::running) <= 0) return "the mission is over";
    if (!obstacle_.empty()) return obstacle_;
    const ForgottenTexts forgotten;
    if (!is_prepared_) library_.prepare(belief, random);
    const double affordable = affordable_steps(budget, horizon);
    const auto states = std::clamp<double>(of_states * affordable / Model::action_count(), 16, 64);
    belief_.draw(belief, static_cast<std::size_t>(states), random);
    library_.drop_unused(gains_);
    double left = of_options * affordable;
    const double found = library_.extend(belief_, left, random);
    gains_.measure(library_.options(), belief_.states(), library_.cells(), left, random);
    steps_ = of_options * affordable - left;
    std::string obstacle = found < enough_found ? "no way to a reward is found from most states" : "";
    if (!is_prepared_ && obstacle.empty()) obstacle_ = obstacle = obstacle_of_model(random);
    is_prepared_ = is_prepared_ || obstacle.empty();
    return obstacle;
  }

  // Decides for the belief of `prepare`. Returns the work as simulations.
  std::uint64_t search(const Belief<Model>& belief, int horizon, Sampler& random, const BarredActions& barred) {
    const ForgottenTexts forgotten;
    candidates_.clear();
    regret_.begin();
    double left = 0;
    tests_.observe_all(library_.cells(), barred, left, random);
    regret_.count(tests_.empty() ? 1 : learned_later);
    const std::vector<std::size_t> likely = likely_options(barred);
    for (const std::size_t option : likely) add_option(option);
    tests_.add_to(candidates_, random);
    moves_.add_to(candidates_, left, random);
    for (const std::size_t option : likely) {
      if (library_.options()[option].size() > 1) moves_.add_view(candidates_, library_.options()[option].front(), barred, left, random);
    }
    settle(belief.probability_of(Ending::running));
    return 1 + static_cast<std::uint64_t>((steps_ - left) / horizon);
  }

  const std::vector<ActionEstimate>& estimates() const { return estimates_; }
  // What decided, for a plan's `why`.
  const char* reason() const { return reason_; }

  void start_over() {
    is_prepared_ = false;
    obstacle_.clear();
    gains_ = {};
  }

 private:
  static constexpr double least_steps = 100'000;
  static constexpr double of_options = 0.4;  // of the affordable steps
  static constexpr double of_states = 0.05;
  static constexpr double enough_found = 0.5;   // of the belief
  static constexpr double most_touching = 0.5;  // of pairs of options
  static constexpr double learned_later = 0.5;  // the share of the regret that counts, where something only observes
  static constexpr std::size_t tried_options = 8;

  // How many steps of the model fit the budget.
  double affordable_steps(Budget budget, int horizon) {
    constexpr double operations_of_second = 1e9;
    if (budget.simulations > 0) return std::max(static_cast<double>(budget.simulations) * horizon, least_steps);
    if (step_cost_ == 0) step_cost_ = std::max(cost_of_step<Model>(), operations_of_step);
    return std::max(budget.seconds * operations_of_second / static_cast<double>(step_cost_), least_steps);
  }

  // What keeps the policy from deciding in this model.
  std::string obstacle_of_model(Sampler& random) {
    if (gains_.touching() > most_touching) return "most ways to a reward change the same variables";
    double left = 0;
    tests_.observe_all(library_.cells(), {}, left, random);
    steps_ -= left;
    const bool only_changes = tests_.empty() && tests_.moves().size() > OptionMoves<Model>::few;
    return only_changes ? "nothing is observed but by what changes the state" : "";
  }

  // The options with the highest income by the belief.
  std::vector<std::size_t> likely_options(const BarredActions& barred) const {
    std::vector<std::pair<double, std::size_t>> incomes;
    for (std::size_t o = 0; o < gains_.size(); ++o) {
      const Option& option = library_.options()[o];
      if (barred.contains(static_cast<std::size_t>(option.front()))) continue;
      incomes.emplace_back(income<Model>(gains_.earned(o, belief_.weights()), option.size()), o);
    }
    std::ranges::stable_sort(incomes, std::greater<>{}, [](const auto& entry) { return entry.first; });
    std::vector<std::size_t> options;
    for (std::size_t i = 0; i < std::min(tried_options, incomes.size()); ++i) options.push_back(incomes[i].second);
    return options;
  }

  void add_option(std::size_t option) {
    const StateWeights after = gains_.after(option, belief_.weights());
    double seen = 0;
    for (std::size_t k = 0; k < after.size(); ++k) seen += after[k] > 0 ? after[k] * gains_.best_in(k, option) : 0;
    const double later = seen - regret_.share() * (seen - gains_.best(after, option));
    const double value = gains_.earned(option, belief_.weights()) + gains_.discount(option) * later;
    candidates_.push_back({library_.options()[option].front(), value, "what can be earned"});
  }

  void settle(double running) {
    estimates_.assign(static_cast<std::size_t>(Model::action_count()), {});
    const OptionCandidate* best = nullptr;
    for (const OptionCandidate& candidate : candidates_) {
      if (best == nullptr || candidate.value > best->value) best = &candidate;
      ActionEstimate& estimate = estimates_[static_cast<std::size_t>(candidate.action)];
      const double value = running * candidate.value;
      if (estimate.n == 0 || value > estimate.q) estimate.q = value;
      estimate.n = static_cast<std::uint32_t>(belief_.size());
      estimate.standard_error = running * regret_.now() / 2;
    }
    reason_ = best != nullptr ? best->reason : "nothing";
  }

  bool is_prepared_ = false;
  std::string obstacle_;
  OptionLibrary<Model> library_;
  OptionGains<Model> gains_;
  double steps_ = 0;
  Operations step_cost_ = 0;  // 0: not known yet
  // Of the last decision:
  SampledBelief<Model> belief_;
  OptionRegret<Model> regret_{belief_, gains_};
  OptionTests<Model> tests_{belief_, regret_};
  OptionMoves<Model> moves_{belief_, regret_, tests_, library_.cells()};
  std::vector<OptionCandidate> candidates_;
  std::vector<ActionEstimate> estimates_;
  const char* reason_ = "";
};

}  // namespace aos
