// Options as a planner: where states cannot be listed and ways to rewards are found (option_policy.hpp).
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/backoff.hpp"
#include "aos/planning/options/option_policy.hpp"
#include "aos/planning/options/plain_plans.hpp"
#include "aos/planning/options/promises.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/pomcp/pomcp.hpp"
#include "aos/planning/seek/seek_planner.hpp"
#include "aos/planning/step_cost.hpp"

namespace aos {

template <class Model>
class OptionsPlanner final : public Planner<Model> {
 public:
  OptionsPlanner(const StateSpace<Model>& space, Pomcp<Model>& pomcp, SeekPlanner<Model>& seek) : Planner<Model>(space), pomcp_(pomcp), seek_(seek) {}

  const char* name() const override { return seeks_ ? seek_.name() : "options"; }

  // POMCP has more to go by where the documents have a rollout policy, or values without observations can be computed.
  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    has_looked_ = false;
    if (is_listed || !switches::options || Model::has_rollout_policy || pomcp_.has_wide_values(belief, horizon)) return false;
    // Options count what comes after an action. Where nothing does, POMCP finds the mean reward of each.
    if (horizon == 1) {
      choosing.why += "; the mission is planned for one decision, which no way to a reward goes beyond";
      return false;
    }
    if (!looks_.is_due()) {
      choosing.why += "; no way to a reward was found a few decisions before";
      return false;
    }
    has_looked_ = true;
    const bool is_first = !finds_nothing_.has_value();
    const bool is_short = budget.seconds > 0 && budget.seconds < first_look_s;
    const std::string obstacle = look(question, is_short && is_first, Sampler{Sampler{random}.bits()}, choosing);
    if (!obstacle.empty()) choosing.why += "; " + obstacle;
    if (is_first && !policy_.knows_ways() && !policy_.earns_anyway()) policy_.look_on(Sampler{random});
    // Where no way at all is known, the next look is put off, each time for longer.
    const bool hides_ways = policy_.earns_anyway() || earns_idle_.value_or(false);
    const bool is_in_vain = !policy_.knows_ways() || hides_ways;
    if (is_in_vain) looks_.fail();
    else looks_.succeed();
    finds_nothing_ = hides_ways || (!policy_.knows_ways() && finds_nothing_.value_or(true));
    return obstacle.empty();
  }

  // Whether no look of this mission has found a way that tells what to do, from any state.
  bool finds_nothing() const { return finds_nothing_.value_or(false); }
  // Whether the last decision has looked for ways.
  bool has_looked() const { return has_looked_; }

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) override {
    const auto start = PlanningClock::now();
    const double before = policy_.taken();
    const std::uint64_t simulations = policy_.search(question.belief, question.horizon, random, question.barred);
    affordable_.note(policy_.taken() - before, PlanningClock::now() - start);
    if (switches::plain_plans) weigh_promises(question, Sampler{Sampler{random}.bits()});
    why += "; ways to rewards are found by search";
    // What is lost for all that options see may be sought.
    seeks_ = (policy_.is_lost() || seek_.has_sought()) && seek_.decides_over(policy_.least(), question, Sampler{random}, why);
    if (!seeks_) why += ", and " + std::string{policy_.reason()} + " decides";
    return simulations;
  }

  Estimates estimates(const Belief<Model>& belief) const override { return seeks_ ? seek_.estimates(belief) : policy_.estimates(); }
  void advance(int action, Observation /*observation*/) override { promises_.note_taken(action); }
  void forget() override { promises_.forget(); }
  void start_over() override {
    promises_ = {};
    policy_.start_over();
    looks_ = Backoff{};
    finds_nothing_.reset();
    is_neglect_dear_.reset();
    earns_idle_.reset();
  }

 private:
  // What the first look of a mission finds decides what is prepared for all of it (docs/lab/budgets.md).
  static constexpr double first_look_s = 0.1;

  // Looks for ways, `longer` than the budget if that is short. Returns why these cannot decide; empty if they can.
  std::string look(const Question<Model>& question, bool longer, Sampler random, Choosing& choosing) {
    Budget budget = question.budget.part(seek_.has_sought() ? 1 - seek_.share : 1);
    std::optional<SearchTime> time;
    if (longer) budget.seconds = first_look_s;
    else time.emplace(choosing);
    const auto start = PlanningClock::now();
    const double affordable = affordable_.of(budget, question.horizon);
    std::string obstacle = policy_.prepare(question.belief, question.horizon, affordable, budget.seconds, random);
    affordable_.note(policy_.taken(), PlanningClock::now() - start);
    if (!obstacle.empty()) return obstacle;
    const ForgottenTexts forgotten;
    if (!is_neglect_dear_) is_neglect_dear_ = policy_.is_neglect_dear(question.horizon, random);
    if (*is_neglect_dear_) return "what is neglected costs more than ways to rewards earn";
    if (!earns_idle_) earns_idle_ = policy_.earns_idle();
    return *earns_idle_ ? "a step that changes nothing earns something" : "";
  }

  // A robot that looks for ever for what pays for itself leaves, or waits, once promises have lost what it could still gain.
  void weigh_promises(const Question<Model>& question, Sampler random) {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    const double running = belief.probability_of(Ending::running);
    if (running <= 0) return;
    const ForgottenTexts forgotten;
    const int chosen = this->choice(policy_.estimates(), horizon, barred);
    const double value = policy_.estimates()[chosen].q;
    promises_.keep(value);
    if (promises_.lost() > 0 && policy_.least() < 0) {
      PlainPlan plain = policy_.plain_plan(horizon, barred, random);
      plain.returned *= running;
      plain.error *= running;
      const double sure = plain.returned - 2 * plain.error;
      if (plain.action >= 0 && sure > std::max(policy_.least(), value - promises_.lost())) return policy_.settle_for(plain, value, promises_.lost());
    }
    promises_.tell(chosen, value, running * policy_.reward_of(chosen, random), Model::discount);
  }

  Pomcp<Model>& pomcp_;
  SeekPlanner<Model>& seek_;
  bool seeks_ = false;  // in the last decision
  OptionPolicy<Model> policy_;
  Promises promises_;
  AffordableSteps<Model> affordable_;
  Backoff looks_;
  bool has_looked_ = false;
  std::optional<bool> finds_nothing_;  // by the looks of a mission
  // By the first decision of a mission that has ways:
  std::optional<bool> is_neglect_dear_;
  std::optional<bool> earns_idle_;
};

}
