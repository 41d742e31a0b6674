// The planner of a model: POMCP or DESPOT, as asked for or as the model's size suggests.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aos/belief.hpp"
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
  // See Pomcp and Despot. DESPOT is better where bounds can be had, and has nothing to go by elsewhere.
  std::uint64_t search(PlannerKind kind, const Belief<Model>& belief, Budget budget, int horizon, Sampler& random) {
    why_ = "it was asked for";
    if (kind == PlannerKind::automatic) {
      const bool has_bounds = despot().prepare(belief, horizon);
      kind = has_bounds ? PlannerKind::despot : PlannerKind::pomcp;
      why_ = has_bounds ? "bounds come from the " + std::to_string(despot().known_states()) +
                              " states that differ in what is yet to be earned"
                        : "there are too many states to derive bounds from";
    }
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
  void move_to(int action, Observation observation) {
    if (used_ == PlannerKind::pomcp) {
      pomcp_.move_to(action, observation);
    } else {
      pomcp_.forget();
    }
  }
  void forget() { pomcp_.forget(); }

 private:
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
