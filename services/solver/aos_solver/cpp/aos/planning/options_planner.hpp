// Options as a planner: where states cannot be listed and ways to rewards are found (option_policy.hpp).
#pragma once

#include <cstdint>
#include <string>

#include "aos/base/clock.hpp"
#include "aos/base/random.hpp"
#include "aos/base/switches.hpp"
#include "aos/belief/belief.hpp"
#include "aos/planning/option_policy.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/pomcp.hpp"

namespace aos {

template <class Model>
class OptionsPlanner final : public Planner<Model> {
 public:
  using typename Planner<Model>::Estimates;

  OptionsPlanner(const StateSpace<Model>& space, Pomcp<Model>& pomcp) : Planner<Model>(space), pomcp_(pomcp) {}

  const char* name() const override { return "options"; }

  // POMCP has more to go by where the documents have a rollout policy, or values without observations can be computed.
  bool prepare(const Question<Model>& question, Sampler& random, Choosing& choosing) override {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    const bool is_asked = is_by_name || (!is_listed && switches::options && !Model::has_rollout_policy && !pomcp_.has_wide_values(belief, horizon));
    if (!is_asked) return false;
    const auto start = thread_time();
    const std::string obstacle = policy_.prepare(belief, budget, horizon, Sampler{Sampler{random}.bits()});
    choosing.searching += thread_time() - start;
    if (!obstacle.empty()) choosing.why += "; " + obstacle;
    return obstacle.empty();
  }

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) override {
    const std::uint64_t simulations = policy_.search(question.belief, question.horizon, random, question.barred);
    why += "; ways to rewards are found by search, and " + std::string{policy_.reason()} + " decides";
    return simulations;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return policy_.estimates(); }
  Estimates values(const Belief<Model>& /*belief*/, Estimates estimates, int /*choice*/) const override { return estimates; }
  void start_over() override { policy_.start_over(); }

 private:
  Pomcp<Model>& pomcp_;
  OptionPolicy<Model> policy_;
};

}  // namespace aos
