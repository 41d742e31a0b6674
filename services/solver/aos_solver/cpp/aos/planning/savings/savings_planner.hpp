// Savings as a planner: where states cannot be listed, and no way to a reward tells what to do (saving_policy.hpp). At the
// first decision of a mission POMCP that ends in rollouts is asked, too, and decides from then on where it tells more.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/options/options_planner.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/pomcp/pomcp.hpp"
#include "aos/planning/savings/saving_policy.hpp"
#include "aos/planning/step_cost.hpp"
#include "aos/planning/values/group_missions.hpp"

namespace aos {

template <class Model>
class SavingsPlanner final : public Planner<Model> {
 public:
  SavingsPlanner(const StateSpace<Model>& space, const OptionsPlanner<Model>& options, Pomcp<Model>& rollouts, GroupMissions<Model>& missions)
      : Planner<Model>(space), options_(options), rollouts_(rollouts), missions_(missions) {}

  const char* name() const override { return "savings"; }

  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    if (!switches::savings || is_listed || !options_.finds_nothing() || belief.probability_of(Ending::running) <= 0) return false;
    Sampler own{Sampler{random}.bits()};
    if (!yields_) {
      if (!policy_.learn(belief, horizon, own)) return false;
      const bool asks = switches::saving_rollouts && !has_asked_;
      find_ways(question, asks ? 1 - of_rollouts : 1, own, choosing);
      if (asks) yields_ = do_rollouts_tell_more(question, own, choosing);
      has_asked_ = true;
    }
    if (!yields_) return true;
    choosing.why += "; to act tells more by rollouts than what it saves";
    return rollouts_.prepare(question, random, choosing);
  }
  Planner<Model>& decider() override { return yields_ ? static_cast<Planner<Model>&>(rollouts_) : *this; }

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) override {
    why += "; what saves most against a rest decides";
    const std::uint64_t simulations = policy_.search(question.belief, question.horizon);
    play_once(question, Sampler{random});
    return simulations;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return policy_.estimates(); }
  // What is told lies halfway between what played missions return and what missions return that see the state. Half of that
  // distance is part of its error.
  Estimates values(const Belief<Model>& belief, Estimates estimates, int choice) const override {
    if (!missions_.is_known()) return estimates;
    const double running = belief.probability_of(Ending::running);
    const double open = running * std::max(policy_.seen() + missions_.loss(), 0.0) / 2;
    const double moved = policy_.resting() - running * missions_.loss() + open - estimates[choice].q;
    for (ActionEstimate& estimate : estimates) {
      estimate.q += moved;
      estimate.standard_error = std::hypot(running * missions_.loss_error(), open);
    }
    return estimates;
  }
  void start_over() override {
    policy_.start_over();
    has_asked_ = false;
    yields_ = false;
  }

 private:
  static constexpr double of_rollouts = 0.5;  // of the budget of a decision that asks it

  void find_ways(const Question<Model>& question, double share, Sampler& random, Choosing& choosing) {
    const SearchTime time{choosing};
    const auto start = PlanningClock::now();
    // A look for options has taken its share of the budget.
    if (options_.has_looked()) share *= 1 - OptionPolicy<Model>::of_options;
    policy_.prepare(question.belief, share * affordable_steps_.of(question.budget, question.horizon, true), question.barred, random);
    affordable_steps_.note(policy_.taken(), PlanningClock::now() - start);
  }

  // Plays missions once in a mission: the values know what a later belief is worth less.
  void play_once(const Question<Model>& question, Sampler random) {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    if (missions_.is_known() || !missions_.is_due(budget, horizon)) return;
    missions_.play(belief, policy_.worths(), nullptr, horizon, this->choice(policy_.estimates(), horizon, barred), Sampler{random.bits()});
  }

  // Whether POMCP that ends in rollouts tells, beyond the error of the difference, more of its choice than savings do of theirs. A tree
  // that ends in values of states is not asked: it promises what no robot returns that does not see the state.
  bool do_rollouts_tell_more(const Question<Model>& question, Sampler& random, Choosing& choosing) {
    const SearchTime time{choosing};
    policy_.search(question.belief, question.horizon);
    play_once(question, Sampler{random});
    const Question<Model> half{question.belief, question.budget.part(of_rollouts), question.horizon, question.barred};
    std::string why;
    rollouts_.prepare(half, random, choosing);
    choosing.simulations += rollouts_.search(half, random, why);
    const ActionEstimate searched = told(rollouts_, question);
    const ActionEstimate saving = told(*this, question);
    return searched.q - saving.q > std::hypot(searched.standard_error, saving.standard_error);
  }
  static ActionEstimate told(const Planner<Model>& planner, const Question<Model>& question) {
    const Estimates estimates = planner.estimates(question.belief);
    const int choice = planner.choice(estimates, question.horizon, question.barred);
    return planner.values(question.belief, estimates, choice)[choice];
  }

  const OptionsPlanner<Model>& options_;
  Pomcp<Model>& rollouts_;
  GroupMissions<Model>& missions_;
  SavingPolicy<Model> policy_;
  AffordableSteps<Model> affordable_steps_;
  bool has_asked_ = false;  // rollouts, in this mission
  bool yields_ = false;     // to rollouts, in this mission
};

}
