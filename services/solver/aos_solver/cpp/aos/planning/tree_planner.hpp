// What planners have in common that search a tree: what they tell of it, and missions that show what it promises too much.
#pragma once

#include "aos/planning/action_values.hpp"
#include "aos/planning/planner.hpp"
#include "aos/planning/values/group_missions.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

template <class Model>
class TreePlanner : public Planner<Model> {
 public:
  TreePlanner(const StateSpace<Model>& space, MdpValues<Model>& values, GroupMissions<Model>& missions)
      : Planner<Model>(space), listed_(values), missions_(missions) {}

  std::uint64_t search(const Question<Model>& question, Sampler& random, std::string& why) final {
    const std::uint64_t simulations = search_tree(question, random, why);
    play_group(question, random);
    return simulations;
  }

  // Values of seen states, or the best of few returns, are too high below each action.
  bool may_put_off() const override { return true; }

  Estimates values(const Belief<Model>& belief, Estimates estimates, int choice) const override {
    bound(belief, estimates);
    const bool was_searched = estimates[choice].n > 0;
    if (values_of_ends() == nullptr) {
      const TreeReach reached = reach(belief, estimates, choice);
      return values_of_tree(std::move(estimates), reached, choice);
    }
    if (!was_searched || !missions_.is_known()) return estimates;
    const double running = belief.probability_of(Ending::running);
    const std::optional<double> doubt = lost_by_doubt(belief);
    const double played = value_of_states(belief) - running * doubt.value_or(missions_.loss());
    const Promise promise{most(belief, estimates, choice), played, running * missions_.loss_error(), has_learned_values() || doubt};
    return values_of_promise(std::move(estimates), promise, choice);
  }

 protected:
  virtual std::uint64_t search_tree(const Question<Model>& question, Sampler& random, std::string& why) = 0;
  // The values of states in which the tree ends; null if it ends in rollouts.
  virtual const StateValues<Model>* values_of_ends() const = 0;
  // Whether these values are learned, and may be wrong by any amount.
  virtual bool has_learned_values() const { return false; }
  // What missions lose by not seeing the state, where they are played to find out what information is worth.
  virtual std::optional<double> lost_by_doubt(const Belief<Model>& /*belief*/) const { return {}; }
  // Their mean over the belief.
  virtual double value_of_states(const Belief<Model>& belief) const = 0;
  // Where a tree ends that has no values of states, and what it has gained over its rollouts.
  virtual TreeReach reach(const Belief<Model>& /*belief*/, const Estimates& /*estimates*/, int /*choice*/) const { return {}; }
  // The most that the tree promises of an action.
  virtual double most(const Belief<Model>& /*belief*/, const Estimates& estimates, int choice) const {
    return estimates[choice].q;
  }

 private:
  // Plays a group of missions where it is time for that. It draws none of the numbers that searches draw.
  void play_group(const Question<Model>& question, Sampler random) {
    const auto& [belief, budget, horizon, barred, is_by_name, is_listed] = question;
    horizon_ = horizon;
    const StateValues<Model>* const values = values_of_ends();
    if (values == nullptr || belief.probability_of(Ending::running) <= 0 || !missions_.is_due(budget, horizon)) return;
    missions_.play(belief, *values, values == &listed_ ? &listed_ : nullptr, horizon,
                   this->choice(this->estimates(belief), horizon, barred), Sampler{random.bits()});
  }

  // Sets the most that each action may return, where the states are listed and have been valued.
  void bound(const Belief<Model>& belief, Estimates& estimates) const {
    if (!listed_.knows(horizon_)) return;
    const List<double> most = listed_.at_most(listed_.space().weights_of(belief));
    for (std::size_t a = 0; a < estimates.size(); ++a) estimates[a].at_most = most[a];
  }

  MdpValues<Model>& listed_;  // where the states are listed
  GroupMissions<Model>& missions_;
  int horizon_ = 1;  // of the last search
};

}
