// Seeking as a planner: where no way to a reward tells what to do, POMCP is asked, and decides unless to seek returns more
// (seek_policy.hpp). Where to seek no longer pays, POMCP goes on: it tells less than it returns, and may find the thing.
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
  SeekPlanner(const StateSpace<Model>& space, Pomcp<Model>& pomcp) : Planner<Model>(space), pomcp_(pomcp) {}

  const char* name() const override { return seeks_ ? "seek" : pomcp_.name(); }

  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    if (!switches::seek || is_by_name || is_listed || horizon == 1 || Model::has_rollout_policy) return false;
    if (belief.probability_of(Ending::running) < 1 || pomcp_.has_wide_values(belief, horizon) || !looks_.is_due()) return false;
    seek(belief, horizon, barred, share * affordable_.of(budget, horizon), random, choosing);
    if (sought_.action < 0 || sought_.returned - (has_sought_ ? 0 : sought_.error) <= policy_.returned_at_once()) return false;
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
    why += seeks_ ? "; to seek what is somewhere returns more, and decides" : "; to seek returns less";
    if (!seeks_) return simulations;
    has_sought_ = true;
    estimates_.assign(estimates_.size(), {});
    estimates_[sought_.action] = {sought_.returned, static_cast<std::uint32_t>(sought_.missions), sought_.error};
    return simulations;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return estimates_; }
  void start_over() override {
    policy_.start_over();
    has_sought_ = false;
    looks_ = Backoff{};
  }

 private:
  void seek(const Belief<Model>& belief, int horizon, const BarredActions& barred, double affordable, Sampler random, Choosing& choosing) {
    const SearchTime time{choosing};
    const auto start = PlanningClock::now();
    const ForgottenTexts forgotten;
    Sampler own{random.bits()};
    sought_ = policy_.find(belief, horizon, barred, affordable, own);
    affordable_.note(affordable, PlanningClock::now() - start);
    if (sought_.action >= 0 || has_sought_) looks_.succeed();
    else looks_.fail();
  }

  static constexpr double share = 0.5;  // of a decision's steps

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
