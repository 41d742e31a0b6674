// Point-based search from the belief of each decision (SARSOP: Kurniawati, Hsu and Lee, 2008), for models whose states
// can be listed. The search itself is in point_based/; this is what it takes from a model, and when it may be used.
//
// Alpha vectors are lower bounds at every belief, so what one decision has found out serves all later ones. Values are
// discounted and of a mission without a horizon.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aos/base/clock.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/flattening.hpp"
#include "aos/planning/relevant_states.hpp"
#include "point_based/online.hpp"

namespace aos {

template <class Model>
class PointBased {
 public:
  // Lists the model if that was not done, as far as the belief needs it. Returns why the search cannot be used; nothing
  // where it can. No budget counts what it takes for the first decision; later it is next to nothing.
  const std::string& prepare(const Belief<Model>& belief) {
    if (!obstacle_.empty()) return obstacle_;
    if (Model::action_count() == 0) return obstacle_ = "there are no actions";
    if (Model::discount >= 1) return obstacle_ = "without a discount there are no bounds to begin with";
    const std::size_t known = states_.size();
    try {
      states_.reach_from(belief);
      running_ = belief.probability_of(Ending::running);
      const Entries entries = entries_of(belief);
      if (search_ && known == states_.size() && search_->move_to(entries)) return obstacle_;
      if (known != states_.size()) starts_.clear();  // their numbers may be others now
      starts_.push_back({1, entries});
      point_based::FlatModel model = Flattening<Model>{states_}.model();
      model.starts = starts_;
      search_ = std::make_unique<point_based::OnlineSarsop>(std::move(model));
      search_->move_to(entries);
    } catch (const NotEnumerable&) {
      obstacle_ = "there are too many states to list";
      search_.reset();
      states_ = {};
    }
    return obstacle_;
  }
  std::size_t states() const { return states_.size(); }
  // What the running part of the prepared belief is worth at least and at most.
  std::pair<double, double> bounds() const { return search_->bounds(); }
  // Backed up in all searches so far.
  std::uint64_t known_simulations() const { return known_; }

  // Forgets what searches have found out, so that a mission does not depend on those before it.
  void start_over() {
    if (search_) search_->start_over();
    known_ = 0;
  }

  // Runs trials from the prepared belief, and returns how many states were backed up: these are its simulations.
  std::uint64_t search(Budget budget) {
    if (running_ <= 0 || (budget.simulations == 0 && budget.seconds <= 0)) return 0;
    const std::uint64_t backed_up = search_->improve(budget.simulations, until(budget, [] { return false; }));
    known_ += backed_up;
    return backed_up;
  }

  // The same below an action that is carried out.
  template <class IsOver>
  void think_about(int action, Budget budget, IsOver&& is_over) {
    if (running_ <= 0 || budget.seconds <= 0) return;
    known_ += search_->improve_below(static_cast<std::uint32_t>(action), 0, until(budget, is_over));
  }

  // What each action is worth at least. `n` is how many trials began with it, and the look at where it leads.
  std::vector<ActionEstimate> estimates() const {
    std::vector<ActionEstimate> result;
    for (const point_based::ActionBounds& bounds : search_->action_bounds()) {
      result.push_back({running_ * bounds.lower, bounds.trials + 1, 0});
    }
    return result;
  }

 private:
  using Entries = std::vector<std::pair<std::uint32_t, double>>;

  Entries entries_of(const Belief<Model>& belief) const {
    Entries entries;
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) == Ending::running) entries.emplace_back(states_.find(state), weight);
    }
    std::sort(entries.begin(), entries.end());
    std::size_t kept = 0;
    for (const auto& [state, weight] : entries) {
      if (kept > 0 && entries[kept - 1].first == state) {
        entries[kept - 1].second += weight;
      } else {
        entries[kept++] = {state, weight};
      }
    }
    entries.resize(kept);
    return entries;
  }

  template <class IsOver>
  static point_based::OnlineSarsop::IsOver until(Budget budget, IsOver&& is_over) {
    return [budget, &is_over, start = PlanningClock::now()] {
      const std::chrono::duration<double> spent = PlanningClock::now() - start;
      return (budget.seconds > 0 && spent.count() >= budget.seconds) || is_over();
    };
  }

  RelevantStates<Model> states_ = RelevantStates<Model>::by_observations();
  std::vector<point_based::Start> starts_;  // one where nothing surprising has happened
  std::unique_ptr<point_based::OnlineSarsop> search_;
  std::string obstacle_;
  double running_ = 0;
  std::uint64_t known_ = 0;
};

}  // namespace aos
