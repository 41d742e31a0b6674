// SARSOP at every decision, with all states that can be reached, or else with those near the belief.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/base/function_ref.hpp"
#include "aos/planning/listed/near_states.hpp"
#include "aos/planning/listed/point_based.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/planner.hpp"
#include "aos/text/rounded_text.hpp"
#include "point_based/constants.hpp"

namespace aos {

template <class Model>
class SarsopPlanner final : public Planner<Model> {
 public:
  explicit SarsopPlanner(const StateSpace<Model>& space) : Planner<Model>(space), space_(space) {}

  const char* name() const override { return "sarsop"; }

  bool prepare(const Question<Model>& question, Sampler& /*random*/, Choosing& choosing) override {
    is_near_ = false;
    if (!question.is_listed) {
      if (serves_near(question, choosing.why)) return true;
      if (question.is_by_name) choosing.why = cannot_be_used + space_.obstacle();
      return false;
    }
    const bool sees_all = !space_.leaves_out_observations();
    const std::string obstacle = sees_all ? all_.prepare(question.belief, question.horizon) : space_.observations_obstacle();
    if (obstacle.empty()) return true;
    if (question.is_by_name) choosing.why = cannot_be_used + obstacle;
    else choosing.why += (sees_all ? std::string{"; "} + cannot_be_used : ", but not what is observed: ") + obstacle;
    return false;
  }

  std::uint64_t search(const Question<Model>& question, Sampler& /*random*/, std::string& why) override {
    const auto chosen = [&] { return this->choice(used().estimates(), question.horizon, question.barred); };
    const std::uint64_t simulations = used().search(question.budget, chosen);
    why += "; " + bounds_text(question);
    const double later = used().later_at_most(chosen());
    if (later > point_based::next_to_nothing * std::abs(used().bounds().second)) {
      why += "; up to " + rounded_up(later) + " of it after the " + std::to_string(question.horizon) + " decisions that values count";
    }
    if (const std::string unplayed = used().unplayed_text(chosen()); !unplayed.empty()) why += ", and " + unplayed;
    if (const auto& policy = used().policy()) {
      why += "; a simple policy decides, since it returns " + rounded_down(policy->value) + " in played missions";
    }
    if (simulations == 0) why += "; preparation and earlier searches have found these bounds, and nothing was searched now";
    return simulations;
  }

  Estimates estimates(const Belief<Model>& /*belief*/) const override { return used().estimates(); }
  Estimates values(const Belief<Model>& /*belief*/, Estimates estimates, int choice) const override {
    return used().values(std::move(estimates), choice);
  }
  double slack(const Belief<Model>& belief, int horizon) const override {
    return (is_near_ ? near_.space() : space_).slack(belief, horizon);
  }
  void ponder(int action, const Question<Model>& question, Sampler& /*random*/, FunctionRef<bool()> is_over) override {
    used().ponder(action, question.budget, is_over);
  }
  void start_over() override {
    all_.start_over();
    near_.start_over();
    near_search_.start_over();
  }
  std::uint64_t known_simulations() const override { return used().known_simulations(); }

 private:
  static constexpr const char* cannot_be_used = "SARSOP cannot be used: ";

  // Whether the states near a belief can stand for all of them. The missions that tell a value make as many decisions as the
  // horizon has, each of them with a whole horizon to go.
  bool serves_near(const Question<Model>& question, std::string& why) {
    const int decisions = 2 * question.horizon;
    is_near_ = switches::near_states && near_.reach(question.belief, decisions) &&
               near_search_.prepare(question.belief, question.horizon).empty();
    if (is_near_) {
      why += "; the " + std::to_string(near_.space().size()) + " states that " + std::to_string(decisions) +
             " decisions can lead to are listed";
    }
    return is_near_;
  }

  std::string bounds_text(const Question<Model>& question) const {
    const auto [lowest, highest] = used().bounds();
    const double unsure = slack(question.belief, question.horizon);
    const double lower = lowest - unsure, upper = highest + unsure;
    const std::string scope =
        used().is_endless() ? "without a horizon" : "with " + std::to_string(question.horizon) + " decisions to go";
    if (space_.estimates_draws() && !is_near_) return scope + " the worth of the belief is an estimate";
    const std::string subject = question.belief.is_drawn() ? " the belief, which was drawn," : " the belief";
    if (used().tells_by_cells()) {
      return scope + subject + " is worth at least " + rounded_down(lower) + ", telling numbers by " +
             std::to_string(used().cells()) + " cells";
    }
    return scope + subject + " is worth between " + rounded_down(lower) + " and " + rounded_up(upper);
  }

  PointBased<Model>& used() { return is_near_ ? near_search_ : all_; }
  const PointBased<Model>& used() const { return is_near_ ? near_search_ : all_; }

  const StateSpace<Model>& space_;
  PointBased<Model> all_{space_};
  NearStates<Model> near_;
  PointBased<Model> near_search_{near_.space(), false};
  bool is_near_ = false;  // whether the states near the belief stood for all of them in the last search
};

}
