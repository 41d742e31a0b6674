// Point-based search from the belief of each decision (SARSOP: Kurniawati, Hsu and Lee, 2008), for models whose states can be
// listed: what gives the search in point_based/ its model, and decides when it may be used. Alpha vectors are lower bounds at
// every belief, so the results of one decision serve all later ones.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/base/statistics.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/action_values.hpp"
#include "aos/planning/backoff.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/listed/number_cells.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "point_based/constants.hpp"
#include "point_based/online.hpp"

namespace aos {

using point_based::share_of_anew, point_based::share_of_missions, point_based::share_of_trials;

template <class Model>
class PointBased {
 public:
  // A space that ends after some decisions, as NearStates do, needs a search with a horizon.
  explicit PointBased(const StateSpace<Model>& space, bool may_be_endless = true) : space_(space), may_be_endless_(may_be_endless) {}

  // Takes the model from a space that lists the belief's states. Returns why the search cannot be used, or an
  // empty text. The first decision may take long here, which no budget counts.
  std::string prepare(const Belief<Model>& belief, int horizon) {
    if (Model::action_count() == 0) return "there are no actions";
    const auto entries = space_.weights_of(belief);
    running_ = belief.probability_of(Ending::running);
    if (entries.empty()) return {};
    const bool is_known = search_ && numbering_ == space_.numbering() && horizon <= most_ahead_;
    horizon_ = horizon;
    if (is_known && serves_horizon() && search_->move_to(entries, is_endless_ ? 0 : static_cast<std::size_t>(horizon))) return {};
    if (numbering_ != space_.numbering()) starts_.clear();
    starts_.push_back({1, entries});
    numbering_ = space_.numbering();
    most_ahead_ = horizon;
    if (tells_by_cells()) {
      if (const std::string obstacle = cells_.choose(space_.reports()); !obstacle.empty()) return obstacle;
    }
    return take_model(entries);
  }
  // Whether observed numbers count by their cells only. Then there are no upper bounds.
  bool tells_by_cells() const { return Model::reports_numbers(); }
  // The largest number of cells for one report.
  std::size_t cells() const { return cells_.max_cells(); }
  // Whether values are those of missions without a horizon. This is so if the discount leaves next to nothing of what
  // comes after the horizon, or half of it where there are many decisions or observations; and if there are too many states
  // for a layer of bounds for each decision.
  bool is_endless() const { return is_endless_; }
  // The bounds of the value of the belief's running part. With cells, the upper one holds for a robot that
  // observes cells only.
  std::pair<double, double> bounds() const {
    if (running_ <= 0) return {0, 0};
    const auto [lower, upper] = search_->bounds();
    return {lower - error_, upper + error_};
  }
  // The simple policy that decides, if one does.
  const std::optional<point_based::PolicyValue>& policy() const { return policy_; }
  // What the error of an action's value rests on, where most of it is that too few missions were played.
  std::string unplayed_text(int action) const {
    if (running_ <= 0 || policy_) return {};
    const point_based::ActionBounds bounds = search_->action_bounds()[static_cast<std::size_t>(action)];
    const double unknown = error_of_unplayed(played_, lost_at_most(bounds.lower));
    const bool is_proven = is_endless_ && unknown >= bounds.upper - bounds.lower;
    return unknown > loss_error_ && !is_proven ? aos::unplayed_text(missions_) : std::string{};
  }
  // How much of the bounds of the belief may come after the decisions that an action's value is of.
  double later_at_most(int action) const {
    return running_ <= 0 ? 0 : later().second * search_->action_bounds()[static_cast<std::size_t>(action)].goes_on;
  }
  // How many simulations all searches took so far.
  std::uint64_t known_simulations() const { return known_; }

  // Forgets what searches have found out, so that a mission does not depend on those before it.
  void start_over() {
    if (search_) search_->start_over();
    policy_tries_ = Backoff{};
    known_ = 0;
  }

  // Runs trials from the prepared belief. Where they leave the bounds apart, simple policies are tried. If these do not
  // decide, missions are played that begin with the action that `choice()` tells then. Returns how many simulations the
  // trials count as; policies and missions are no search.
  std::uint64_t search(Budget budget, auto&& choice) {
    loss_ = loss_error_ = later_ = 0;
    missions_ = 0;
    played_ = 0;
    policy_.reset();
    anew_.reset();
    if (running_ <= 0 || (budget.simulations == 0 && budget.seconds <= 0)) return 0;
    const Operations most = budget.operations(horizon_);
    const auto work_of = [&](double share) { return static_cast<Operations>(share * static_cast<double>(most)); };
    const auto never = [] { return false; };
    const auto over_after = [&](double share) {
      Budget part = budget;
      part.seconds *= share;
      return until(part, never);
    };
    const auto trials_are_over = over_after(share_of_trials), policies_are_over = over_after(1 - share_of_missions);
    const auto anew_is_over = over_after(1 - share_of_missions + share_of_anew);
    const auto is_over = over_after(1);
    Operations searched = 0, work = 0;
    // Runs trials until a share of the budget is spent. What the last one has found is taken until `is_late()`.
    const auto try_until = [&](double share, const auto& is_spent, const auto& is_late) {
      if ((most > 0 && work >= work_of(share)) || is_spent()) return;
      const Operations trials = search_->improve(most == 0 ? 0 : work_of(share) - work, is_spent, is_late);
      searched += trials;
      work += trials;
    };
    try_until(share_of_trials, trials_are_over, policies_are_over);
    const Operations most_of_policies = std::max<Operations>(work_of(1 - share_of_missions - share_of_trials), most > 0);
    if (policy_tries_.is_due()) try_policies({most_of_policies, policies_are_over}, {most == 0 ? 0 : most - std::min(work, most - 1), is_over}, work);
    if (!policy_) try_until(1 - share_of_missions, policies_are_over, is_over);
    search_->open_actions(is_over);
    const Operations most_of_anew = std::max<Operations>(work_of(share_of_anew), most > 0);
    anew_ = search_->best_policy(static_cast<std::size_t>(horizon_), {most_of_anew, anew_is_over}, work, /*decides_anew=*/true);
    if (!policy_ && (most == 0 || work < most) && !is_over()) work += play(choice(), most == 0 ? 0 : most - work, is_over);
    try_until(1, is_over, is_over);
    const std::uint64_t simulations = Budget::simulations_of(searched, horizon_);
    known_ += simulations;
    return simulations;
  }

  // Runs trials below an action that is being carried out.
  void ponder(int action, Budget budget, auto&& is_over) {
    if (running_ <= 0 || budget.seconds <= 0) return;
    const Operations work = search_->improve_below(static_cast<std::uint32_t>(action), until(budget, is_over));
    known_ += Budget::simulations_of(work, horizon_);
  }

  // The lower bounds of the actions, or what a policy returns that begins with one; the decision is made by these. `n`
  // counts the trials that began with the action, and 1 for opening it. What is proven holds for the next `horizon`
  // decisions, also where the search has no horizon.
  Estimates estimates() const {
    if (running_ <= 0) return Estimates(static_cast<std::size_t>(Model::action_count()));
    const auto [least_later, most_later] = later();
    Estimates result;
    for (const point_based::ActionBounds& bounds : search_->action_bounds()) {
      const double lower = bounds.lower - error_;
      result.push_back({lower, bounds.trials + 1, 0, 0, lower - bounds.goes_on * most_later});
      if (!tells_by_cells()) result.back().at_most = bounds.upper + error_ - bounds.goes_on * least_later;
    }
    if (policy_) {
      // Missions that were lucky may have returned more than is possible.
      const double upper = search_->action_bounds()[policy_->action].upper + error_;
      double& value = result[policy_->action].q;
      value = std::max(value, std::min(policy_->value, upper));
    }
    return result;
  }
  // Estimates with a value between the bounds. Where a simple policy returns more than is proven, it is what missions by that policy
  // return: the middle promises half of a gap that nobody has closed. Where the search has no horizon, missions tell what comes after the horizon.
  // Without missions it is worth nothing at least, and as much as now at most.
  Estimates values(Estimates estimates, int choice) const {
    if (running_ <= 0) return estimates;
    const auto [worst, best] = search_->bounds();
    const double left = is_endless_ && missions_ == 0 ? std::pow(Model::discount, horizon_) : 0;
    const double lost = later_ + std::max(loss_, 0.0), gained = std::max(-loss_, 0.0);
    List<double> lowers, uppers;
    for (const point_based::ActionBounds& bounds : search_->action_bounds()) {
      const double going_on = left * bounds.goes_on;
      uppers.push_back(bounds.upper + error_ - lost - going_on * std::min(worst, 0.0));
      lowers.push_back(std::min(bounds.lower - error_ - lost + gained - going_on * std::max(best, 0.0), uppers.back()));
    }
    double beyond = 0;  // the policy, which later searches may better
    if (policy_) {
      double& lower = lowers[choice];
      double& upper = uppers[choice];
      lower = std::clamp(policy_->within, lower, upper);
      beyond = (upper - lower) / 2;
      upper = lower;
    }
    set_between(estimates, lowers, uppers, choice);
    const ActionEstimate& chosen = estimates[static_cast<std::size_t>(choice)];
    double unknown = std::hypot(error_of_missions(chosen.q), beyond);
    // Without a horizon a mission that plans anew returns what is proven: lower bounds hold for the next decision, too.
    if (is_endless_ && !policy_) unknown = std::min(unknown, chosen.at_most - chosen.at_least);
    for (ActionEstimate& estimate : estimates) {
      estimate.q = std::min(estimate.q, estimate.at_most);
      estimate.standard_error = std::hypot(estimate.standard_error, unknown);
    }
    return estimates;
  }

 private:
  using Limit = point_based::OnlineSarsop::Limit;

  // Finds out whether a simple policy decides. Where none does, or too few missions were played to tell, the next tries are put
  // off, and trials have the time.
  void try_policies(const Limit& usual, const Limit& most, Operations& work) {
    const Operations before = work;
    policy_ = search_->best_policy(static_cast<std::size_t>(horizon_), usual, most, work);
    if (policy_) policy_tries_.succeed();
    else if (work > before) policy_tries_.fail();
  }

  // Finds what missions lose that begin with an action and plan anew at each step. Returns the work.
  Operations play(int action, Operations most, const point_based::OnlineSarsop::IsOver& is_over) {
    Operations work = 0;
    const auto losses = search_->losses(static_cast<std::uint32_t>(action), static_cast<std::size_t>(horizon_), most, is_over, work);
    missions_ = losses.size();
    const auto count = static_cast<double>(losses.size());
    double unsettled = 0, squares = 0;
    for (const point_based::MissionLoss& loss : losses) {
      loss_ += loss.all / count;
      later_ += loss.later / count;
      unsettled += std::abs(loss.unsettled) / count;
      played_ += loss.played;
    }
    const double all = loss_ + later_;
    for (const point_based::MissionLoss& loss : losses) squares += std::pow(loss.all + loss.later - all, 2);
    // The mission itself may decide otherwise there. One mission alone tells no more than the size of what is lost.
    loss_error_ = std::hypot(unsettled, count > 1 ? std::sqrt(squares / (count - 1) / count) : std::abs(all));
    return work;
  }

  // The error of what planning anew loses: that of the missions that were played, and that too few were. A simple policy that
  // decides anew tells how much may be lost, with twice the error of its mean: it puts off for ever what the mission may put off.
  double error_of_missions(double promised) const {
    return std::hypot(loss_error_, policy_ ? policy_->standard_error : 0, error_of_unplayed(played_, lost_at_most(promised)));
  }
  double lost_at_most(double promised) const {
    return anew_ ? promised - (anew_->value - 2 * anew_->standard_error) : std::abs(promised);
  }

  std::string take_model(const List<std::pair<std::uint32_t, double>>& entries) {
    point_based::FlatModel model = flat_model();
    error_ = error_of(model);
    is_large_ = is_large(model);
    is_endless_ = switches::endless && may_be_endless_ && Model::discount < 1 && hardly_has_end();
    try {
      search_ = search_with(std::move(model), is_endless_ ? 0 : horizon_);
    } catch (const std::length_error&) {
      search_.reset();
      if (!may_be_endless_) return "there are too many states for so long a horizon";
      if (Model::discount >= 1) return "there are too many states for so long a horizon without a discount";
      is_endless_ = true;
      search_ = search_with(flat_model(), 0);
    }
    search_->move_to(entries);
    return {};
  }
  // Whether the discount leaves little enough of what comes after the horizon for a search that has none.
  bool hardly_has_end() const {
    const double most_later = is_long() || is_large_ ? point_based::much : point_based::next_to_nothing;
    return std::pow(Model::discount, horizon_) <= most_later;
  }
  // Whether the search can be used with a horizon that has become shorter, as the last decisions before a step limit have it.
  bool serves_horizon() const { return !is_endless_ || horizon_ == most_ahead_ || hardly_has_end(); }
  // What may be left of a value without a horizon for what comes after the horizon: at least and at most.
  std::pair<double, double> later() const {
    if (!is_endless_) return {0, 0};
    const double left = std::pow(Model::discount, horizon_) * (1 + 1e-9);
    const auto [least, most] = search_->extremes();
    return {left * least, left * most};
  }
  // Whether there are many layers, so that a search hardly closes the bounds of each.
  bool is_long() const { return horizon_ > 30; }
  // Whether it takes long to go through all observations of all states once for each decision to go.
  bool is_large(const point_based::FlatModel& model) const {
    double likelihoods = 0;
    for (const point_based::Outcome& outcome : model.outcomes.elements) likelihoods += static_cast<double>(model.likelihoods[outcome.sensing].size());
    return likelihoods * horizon_ > point_based::max_likelihoods_in_layers;
  }
  point_based::FlatModel flat_model() const {
    point_based::FlatModel model = space_.rows();
    if (tells_by_cells()) {
      model.likelihoods = cells_.by_cells(model.likelihoods);
      model.observations = cells_.observations();
    }
    model.starts = starts_;
    return model;
  }
  static std::unique_ptr<point_based::OnlineSarsop> search_with(point_based::FlatModel model, int horizon) {
    model.horizon = static_cast<std::size_t>(horizon);
    return std::make_unique<point_based::OnlineSarsop>(std::move(model));
  }
  // How far errors in the probabilities of cells may move values: at each decision, by their share of all that follows.
  double error_of(const point_based::FlatModel& model) const {
    if (!tells_by_cells()) return 0;
    const double decisions = std::min(static_cast<double>(horizon_), 1 / (1 - Model::discount));
    return NumberCells::error * largest_size(model.rewards) * decisions * decisions;
  }

  static point_based::OnlineSarsop::IsOver until(Budget budget, auto&& is_over) {
    return [budget, &is_over, start = PlanningClock::now()] {
      return (budget.seconds > 0 && seconds_since(start) >= budget.seconds) || is_over();
    };
  }

  const StateSpace<Model>& space_;
  const bool may_be_endless_;
  Numbering numbering_;                          // of the model that was taken
  List<point_based::Start> starts_;  // only one unless something surprising has happened
  std::unique_ptr<point_based::OnlineSarsop> search_;
  int horizon_ = 1;  // decisions
  int most_ahead_ = 1;  // the longest horizon that the search serves
  bool is_endless_ = false;
  bool is_large_ = false;
  NumberCells cells_;
  double error_ = 0;  // of bounds
  double running_ = 0;
  Backoff policy_tries_;
  std::optional<point_based::PolicyValue> policy_;  // that decides, since it returns more than is proven
  std::optional<point_based::PolicyValue> anew_;    // that decides anew with the whole horizon at each step
  std::size_t missions_ = 0;  // that were played from this belief
  double played_ = 0;         // of them, those that broke off by the share that was played
  double loss_ = 0;   // of missions that plan anew, against the lower bound
  double later_ = 0;  // of the lower bound, beyond the horizon
  double loss_error_ = 0;
  std::uint64_t known_ = 0;
};

}
