// Seeking as a planner: where no way to a reward tells what to do, POMCP is asked, and decides unless to seek returns more
// (seek_policy.hpp). Where to seek no longer pays, POMCP goes on: it tells less than it returns, and may find the thing.
// Options ask it, too, where all that they see is a lost step.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/backoff.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/pomcp/pomcp.hpp"
#include "aos/planning/seek/seek_policy.hpp"
#include "aos/planning/step_cost.hpp"

namespace aos {

template <class Model>
class SeekPlanner final : public Planner<Model> {
 public:
  static constexpr double share = 0.5;  // of a decision's steps

  SeekPlanner(const StateSpace<Model>& space, Pomcp<Model>& pomcp) : Planner<Model>(space), pomcp_(pomcp) {}

  const char* name() const override { return seeks_ ? "seek" : pomcp_.name(); }

  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    if (!is_open(question)) return false;
    {
      const SearchTime time{choosing};
      seek(question, random);
    }
    note(sought_.action >= 0);
    if (!is_more_than(policy_.returned_at_once())) return false;
    pomcp_.prepare(question, random, choosing);
    return true;
  }

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) override {
    const std::uint64_t simulations = pomcp_.search(question, random, why);
    estimates_ = pomcp_.estimates(question.belief);
    const auto chosen = static_cast<std::size_t>(pomcp_.choice(estimates_, question.horizon, question.barred));
    // A tree that ends in values of seen states promises what no robot returns that does not see them.
    estimates_ = pomcp_.values(question.belief, std::move(estimates_), chosen);
    seeks_ = sought_.returned > estimates_[chosen].q;
    if (seeks_) settle(why);
    else why += "; to seek returns less";
    // Seeking may have left no time for simulations, and yet it has tried an action.
    return std::max<std::uint64_t>(simulations, 1);
  }

  // Whether missions that seek return more than `least`, what the choice of another planner returns if nothing more is observed.
  bool decides_over(double least, const Question<Model>& question, Sampler random, std::string& why) {
    seeks_ = false;
    if (!is_open(question)) return false;
    seek(question, random);
    seeks_ = is_more_than(std::max(least, policy_.returned_at_once()));
    note(seeks_);
    if (seeks_) settle(why);
    return seeks_;
  }
  bool has_sought() const { return has_sought_; }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return estimates_; }
  void start_over() override {
    policy_.start_over();
    has_sought_ = false;
    looks_ = Backoff{};
  }

 private:
  bool is_open(const Question<Model>& question) {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    if (!switches::seek || is_listed || horizon == 1 || Model::has_rollout_policy) return false;
    return belief.probability_of(Ending::running) >= 1 && !pomcp_.has_wide_values(belief, horizon) && looks_.is_due();
  }
  void seek(const Question<Model>& question, Sampler random) {
    const auto start = PlanningClock::now();
    const ForgottenTexts forgotten;
    const double affordable = share * affordable_.of(question.budget, question.horizon);
    Sampler own{random.bits()};
    sought_ = policy_.find(question.belief, question.horizon, question.barred, affordable, own);
    affordable_.note(affordable, PlanningClock::now() - start);
  }
  // Puts the next look off where this one was in vain.
  void note(bool was_worth_it) {
    if (was_worth_it || has_sought_) looks_.succeed();
    else looks_.fail();
  }
  bool is_more_than(double returned) const {
    return sought_.action >= 0 && sought_.returned - (has_sought_ ? 0 : sought_.error) > returned;
  }
  void settle(std::string& why) {
    why += "; to seek what is somewhere returns more, and decides";
    has_sought_ = true;
    estimates_.assign(Model::action_count(), {});
    estimates_[sought_.action] = {sought_.returned, static_cast<std::uint32_t>(sought_.missions), sought_.error};
  }

  Pomcp<Model>& pomcp_;
  SeekPolicy<Model> policy_;
  AffordableSteps<Model> affordable_;
  Sought sought_;
  Estimates estimates_;
  Backoff looks_;
  bool seeks_ = false;       // in the last decision
  bool has_sought_ = false;  // in this mission
};

}
