// The planner of a model: POMCP, DESPOT or SARSOP, as asked for or as the model's size suggests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/despot.hpp"
#include "aos/planning/point_based.hpp"
#include "aos/planning/pomcp.hpp"

namespace aos {

enum class PlannerKind { pomcp, despot, sarsop, automatic };

// What of a value may come from beyond the horizon, for `automatic` to count without one.
inline constexpr double negligible_beyond = 0.2;

// Nothing where there is no such planner.
inline std::optional<PlannerKind> planner_kind(std::string_view name) {
  if (name == "pomcp") return PlannerKind::pomcp;
  if (name == "despot") return PlannerKind::despot;
  if (name == "sarsop") return PlannerKind::sarsop;
  if (name == "auto") return PlannerKind::automatic;
  return std::nullopt;
}

template <class Model>
class Planner {
 public:
  // See Pomcp, Despot and PointBased. `automatic` takes SARSOP where the states can be listed and the horizon hardly
  // matters; else DESPOT where its scenarios can have each state that matters among them, and POMCP with more states.
  std::uint64_t search(PlannerKind kind, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random) {
    used_ = suited_kind(kind, belief, horizon);
    if (used_ == PlannerKind::despot) return despot().search(belief, budget, horizon, random);
    if (used_ == PlannerKind::pomcp) return pomcp_.search(belief, budget, horizon, random);
    const std::uint64_t simulations = point_based_.search(budget);
    why_ += "; " + bounds_text();
    return simulations;
  }

  // The planner of the last search, and why it was that one.
  const char* name() const {
    return used_ == PlannerKind::sarsop ? "sarsop" : used_ == PlannerKind::despot ? "despot" : "pomcp";
  }
  const std::string& why() const { return why_; }

  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    if (used_ == PlannerKind::sarsop) return point_based_.estimates();
    return used_ == PlannerKind::despot ? despot_->estimates(belief) : pomcp_.estimates(belief);
  }
  // What to do: what is worth most, as far as its value can be believed.
  int choice(const std::vector<ActionEstimate>& estimates) const {
    std::uint32_t most = 0;
    for (const ActionEstimate& estimate : estimates) most = std::max(most, estimate.n);
    int best = -1;
    for (int action = 0; action < static_cast<int>(estimates.size()); ++action) {
      const ActionEstimate& candidate = estimates[static_cast<std::size_t>(action)];
      const bool counts = used_ == PlannerKind::pomcp ? is_well_visited(candidate.n, most) : candidate.n > 0;
      if (counts && (best < 0 || candidate.q > estimates[static_cast<std::size_t>(best)].q)) best = action;
    }
    return std::max(best, 0);
  }

  // Looks ahead below the action that is carried out, if the last search was one that can use it.
  template <class IsOver>
  void think_about(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                   IsOver&& is_over) {
    if (used_ == PlannerKind::pomcp) pomcp_.think_about(action, belief, budget, horizon, random, is_over);
    if (used_ == PlannerKind::sarsop) point_based_.think_about(action, budget, is_over);
  }
  // How many simulations the next search need not make, since they were made before.
  std::uint64_t known_simulations() const {
    return used_ == PlannerKind::sarsop ? point_based_.known_simulations() : pomcp_.known_simulations();
  }

  void move_to(int action, Observation observation) {
    if (used_ == PlannerKind::pomcp) {
      pomcp_.move_to(action, observation);
    } else {
      pomcp_.forget();
    }
  }
  // What is known below the belief holds no longer.
  void forget() { pomcp_.forget(); }
  // Another mission begins.
  void start_over() {
    forget();
    point_based_.start_over();
  }

 private:
  // Sets `why_`.
  PlannerKind suited_kind(PlannerKind asked_for, const Belief<Model>& belief, int horizon) {
    why_ = "it was asked for";
    if (asked_for == PlannerKind::pomcp || asked_for == PlannerKind::despot) return asked_for;
    const bool may_choose = asked_for == PlannerKind::automatic;
    const double beyond = std::pow(Model::discount, horizon);
    if (may_choose && beyond > negligible_beyond) {
      why_ = "SARSOP reckons without the horizon, beyond which rewards still count";
      return sampling_kind(belief, horizon);
    }
    if (const std::string& obstacle = point_based_.prepare(belief); !obstacle.empty()) {
      why_ = "SARSOP cannot be used: " + obstacle;
      return may_choose ? sampling_kind(belief, horizon) : PlannerKind::pomcp;
    }
    if (may_choose) why_ = std::to_string(point_based_.states()) + " states matter, so that all can be listed";
    return PlannerKind::sarsop;
  }

  // Goes on with `why_`.
  PlannerKind sampling_kind(const Belief<Model>& belief, int horizon) {
    if (!pomcp_.prepare(belief, horizon)) {
      why_ += "; there are too many states to derive bounds from";
      return PlannerKind::pomcp;
    }
    const std::size_t states = pomcp_.known_states();
    why_ += "; " + std::to_string(states) + " states differ in what is yet to be earned, ";
    if (states > most_scenarios) {
      why_ += "more than DESPOT has scenarios";
      return PlannerKind::pomcp;
    }
    why_ += "so that DESPOT's scenarios cover them";
    return PlannerKind::despot;
  }

  std::string bounds_text() const {
    const auto [lower, upper] = point_based_.bounds();
    char text[96];
    std::snprintf(text, sizeof text, "without a horizon the belief is worth between %.4g and %.4g", lower, upper);
    return text;
  }

  Despot<Model>& despot() {
    if (!despot_) despot_ = std::make_unique<Despot<Model>>();
    return *despot_;
  }

  Pomcp<Model> pomcp_;
  PointBased<Model> point_based_;
  std::unique_ptr<Despot<Model>> despot_;
  PlannerKind used_ = PlannerKind::pomcp;
  std::string why_;
};

}  // namespace aos
