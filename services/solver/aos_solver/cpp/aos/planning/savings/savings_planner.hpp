// Savings as a planner: where states cannot be listed, and no way to a reward tells what to do (saving_policy.hpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/draws/random.hpp"
#include "aos/planning/options/options_planner.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/savings/saving_policy.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/values/group_missions.hpp"

namespace aos {

template <class Model>
class SavingsPlanner final : public Planner<Model> {
 public:
  using typename Planner<Model>::Estimates;

  SavingsPlanner(const StateSpace<Model>& space, const OptionsPlanner<Model>& options, GroupMissions<Model>& missions)
      : Planner<Model>(space), options_(options), missions_(missions) {}

  const char* name() const override { return "savings"; }

  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    const bool is_asked = is_by_name || (switches::savings && !is_listed && options_.finds_nothing());
    if (!is_asked || belief.probability_of(Ending::running) <= 0) return false;
    const ForgottenTexts forgotten;
    Sampler own{Sampler{random}.bits()};
    if (!policy_.learn(belief, horizon, own)) return false;
    const SearchTime time{choosing};
    const auto start = PlanningClock::now();
    // A look for options has taken its share of the budget.
    const double share = options_.has_looked() ? 1 - OptionPolicy<Model>::of_options : 1;
    policy_.prepare(belief, share * affordable_steps_.of(budget, horizon), barred, own);
    affordable_steps_.note(policy_.taken(), PlanningClock::now() - start);
    return true;
  }

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    why += "; what saves most against a rest decides";
    const std::uint64_t simulations = policy_.search(belief, horizon);
    // Played once in a mission: the values know what a later belief is worth less.
    if (!missions_.is_known() && missions_.is_due(budget, horizon)) {
      missions_.play(belief, policy_.worths(), nullptr, horizon, this->choice(policy_.estimates(), horizon, barred), Sampler{Sampler{random}.bits()});
    }
    return simulations;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return policy_.estimates(); }
  // What is told lies halfway between what played missions return and what missions return that see the state. Half of that
  // distance is part of its error.
  Estimates values(const Belief<Model>& belief, Estimates estimates, int choice) const override {
    if (!missions_.is_known()) return estimates;
    const double running = belief.probability_of(Ending::running);
    const double open = running * std::max(policy_.seen() + missions_.loss(), 0.0) / 2;
    const double moved = policy_.resting() - running * missions_.loss() + open - estimates[static_cast<std::size_t>(choice)].q;
    for (ActionEstimate& estimate : estimates) {
      estimate.q += moved;
      estimate.standard_error = std::hypot(running * missions_.loss_error(), open);
    }
    return estimates;
  }
  void start_over() override { policy_.start_over(); }

 private:
  const OptionsPlanner<Model>& options_;
  GroupMissions<Model>& missions_;
  SavingPolicy<Model> policy_;
  AffordableSteps<Model> affordable_steps_;
};

}  // namespace aos
