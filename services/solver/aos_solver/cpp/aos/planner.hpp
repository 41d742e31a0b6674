// The planner of a model: POMCP or DESPOT, as asked for or as the model's size suggests.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aos/belief.hpp"
#include "aos/budget.hpp"
#include "aos/despot.hpp"
#include "aos/pomcp.hpp"
#include "aos/random.hpp"
#include "aos/step.hpp"

namespace aos {

enum class PlannerKind { pomcp, despot, automatic };

// Nothing where there is no such planner.
inline std::optional<PlannerKind> planner_kind(std::string_view name) {
  if (name == "pomcp") return PlannerKind::pomcp;
  if (name == "despot") return PlannerKind::despot;
  if (name == "auto") return PlannerKind::automatic;
  return std::nullopt;
}

template <class Model>
class Planner {
 public:
  // See Pomcp and Despot. `automatic` takes DESPOT where its scenarios can have each state that matters among them; with
  // more states POMCP has earned more wherever both were measured, and without bounds DESPOT has nothing to go by.
  std::uint64_t search(PlannerKind kind, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random) {
    why_ = "it was asked for";
    if (kind == PlannerKind::automatic) kind = suited_kind(belief, horizon);
    used_ = kind;
    return kind == PlannerKind::despot ? despot().search(belief, budget, horizon, random)
                                       : pomcp_.search(belief, budget, horizon, random);
  }

  // The planner of the last search, and why it was that one.
  const char* name() const { return used_ == PlannerKind::despot ? "despot" : "pomcp"; }
  const std::string& why() const { return why_; }

  std::vector<ActionEstimate> estimates(const Belief<Model>& belief) const {
    return used_ == PlannerKind::despot ? despot_->estimates(belief) : pomcp_.estimates(belief);
  }
  // What to do: what is worth most, as far as its value can be believed.
  int choice(const std::vector<ActionEstimate>& estimates) const {
    std::uint32_t most = 0;
    for (const ActionEstimate& estimate : estimates) most = std::max(most, estimate.n);
    int best = -1;
    for (int action = 0; action < static_cast<int>(estimates.size()); ++action) {
      const ActionEstimate& candidate = estimates[static_cast<std::size_t>(action)];
      const bool counts = used_ == PlannerKind::despot ? candidate.n > 0 : is_well_visited(candidate.n, most);
      if (counts && (best < 0 || candidate.q > estimates[static_cast<std::size_t>(best)].q)) best = action;
    }
    return std::max(best, 0);
  }

  // Looks ahead below the action that is carried out, if the last search was one that can use it.
  template <class IsOver>
  void think_about(int action, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random,
                   IsOver&& is_over) {
    if (used_ == PlannerKind::pomcp) pomcp_.think_about(action, belief, budget, horizon, random, is_over);
  }
  // How many simulations the next search need not make, since they were made before.
  std::uint64_t known_simulations() const { return pomcp_.known_simulations(); }

  void move_to(int action, Observation observation) {
    if (used_ == PlannerKind::pomcp) {
      pomcp_.move_to(action, observation);
    } else {
      pomcp_.forget();
    }
  }
  void forget() { pomcp_.forget(); }

 private:
  PlannerKind suited_kind(const Belief<Model>& belief, int horizon) {
    if (!pomcp_.prepare(belief, horizon)) {
      why_ = "there are too many states to derive bounds from";
      return PlannerKind::pomcp;
    }
    const std::size_t states = pomcp_.known_states();
    why_ = std::to_string(states) + " states differ in what is yet to be earned, ";
    if (states > most_scenarios) {
      why_ += "more than DESPOT has scenarios";
      return PlannerKind::pomcp;
    }
    why_ += "so that DESPOT's scenarios cover them";
    return PlannerKind::despot;
  }

  Despot<Model>& despot() {
    if (!despot_) despot_ = std::make_unique<Despot<Model>>();
    return *despot_;
  }

  Pomcp<Model> pomcp_;
  std::unique_ptr<Despot<Model>> despot_;
  PlannerKind used_ = PlannerKind::pomcp;
  std::string why_;
};

}  // namespace aos
