// Decides where the states cannot be listed: which option to take, or what to find out before.
//
// A few states of the belief stand for it. Options are ways to what can be earned from one of them (option_search.hpp).
// What the best options earn by the weights of the states is what the robot earns if it observes nothing more. Where the
// state is seen they earn more, and the difference is the regret of not knowing it. So an observation is worth the regret
// that it takes away. The robot does what has the highest sum of what is earned on the way and what the seen states are worth
// after it, less the regret that is left. It may
//
//   take an option;
//   observe, once or several times in a row (blinkered value of information: Hay, Russell, Tolpin and Shimony, 2012);
//   move, and observe on the way or where it leads.
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/options/deadline.hpp"
#include "aos/planning/options/option_detours.hpp"
#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/option_library.hpp"
#include "aos/planning/options/option_moves.hpp"
#include "aos/planning/options/option_pairs.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/option_tests.hpp"
#include "aos/planning/options/option_twins.hpp"
#include "aos/planning/options/option_values.hpp"
#include "aos/planning/options/own_changes.hpp"
#include "aos/planning/options/plain_plans.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/test_plans.hpp"

namespace aos {

template <class Model>
class OptionPolicy {
 public:
  using State = typename Model::State;
  static constexpr double of_options = 0.4;  // of the affordable steps: to find options and what they earn

  // Draws states and finds options within so many steps of the model, and so many seconds if these are above 0. Returns why this policy cannot decide; empty if it can.
  std::string prepare(const Belief<Model>& belief, int horizon, double affordable, double seconds, Sampler random) {
    taken_ = 0;
    twins_.forget();
    if (belief.probability_of(Ending::running) <= 0) return "the mission is over";
    if (!obstacle_.empty()) return obstacle_;
    const ForgottenTexts forgotten;
    clock_.begin(seconds);
    clock_.end_at(of_options);
    if (!is_prepared_) library_.prepare(belief, random);
    affordable_ = affordable;
    const auto states = std::clamp<double>(of_states * affordable_ / Model::action_count(), 16, library_.counts() ? 32 : 64);
    const auto all_else = [&](const State& state) { return library_.running_down().all_else_of(state); };
    if (switches::alike_states) belief_.draw_alike(belief, static_cast<std::size_t>(states), all_else, random);
    else belief_.draw(belief, static_cast<std::size_t>(states), random);
    const auto set_back = [&](State& state) { if (switches::alike_states) library_.running_down().set_back(state); };
    if (switches::raked_states) belief_.rake(belief, library_.searched_cells(), set_back, random);
    library_.drop_unused(gains_, taken_way_);
    double left = of_options * affordable_;
    changes_.measure(belief_.states(), library_.cells(), left, random);
    if (!is_prepared_ && changes_.earns_anyway()) return obstacle_ = "the next step earns something whatever the robot does";
    if (switches::own_ways) library_.look_first_at_own(changes_);
    const double found = find_ways(left, random);
    clock_.end_at(of_gains);
    later_.begin(horizon, changes_.idle_action());
    gains_.measure(library_, belief_, states, changes_, later_, left, random);
    if (switches::deadlines) gains_.end_after(steps_to_deadline(belief_, library_.running_down(), random));
    taken_ = of_options * affordable_ - left;
    std::string obstacle = found < (switches::enough_ways ? enough_found : 1e-9) ? "no way to a reward is found from most states" : "";
    if (!is_prepared_ && obstacle.empty()) obstacle_ = obstacle = obstacle_of_model(random);
    is_prepared_ = is_prepared_ || obstacle.empty();
    return obstacle;
  }

  // Looks once more for a way from any state of `prepare`. That there is none is told by a number of steps, which is the same on slow machines.
  void look_on(Sampler random) {
    const ForgottenTexts forgotten;
    clock_.begin(0);
    library_.find_any(belief_.states(), whole_look, random);
  }

  // Decides for the belief of `prepare`. Returns the work as simulations.
  std::uint64_t search(const Belief<Model>& belief, int horizon, Sampler& random, const BarredActions& barred) {
    const ForgottenTexts forgotten;
    candidates_.clear();
    waited_ = 0;
    choose_moves(barred);
    regret_.begin();
    const double kept = switches::detours && was_idle_ ? of_detours : 0;
    double left = (1 - kept) * affordable_ - taken_ - gains_.kept_steps();
    clock_.end_at(of_all - kept);
    values_.begin(belief_, horizon, tried_options + tried_moves_.size(), left, random);
    List<std::size_t> likely = likely_options(barred);
    regret_.watch(likely);
    if (regret_.now() > matters * std::abs(regret_.value_seen())) {
      if (switches::twins && !library_.counts() && changes_.leaves_tests()) twins_.find(belief, of_twins * left, left, random);
      tests_.observe_all(barred, left, random);
      if (switches::test_plans && !library_.counts() && !twins_.are_known()) {
        add_plans(barred, left, random);
        likely = likely_options(barred);
        regret_.watch(likely);
      }
      add_observations(likely, barred, left, random);
    }
    const std::size_t observing = candidates_.size();
    for (std::size_t i = 0; i < likely.size(); ++i) add_option(likely[i], i, observing, left, random);
    note_way(likely, observing);
    if (switches::tests_first) pairs_.add_to(candidates_, observing, left, random);
    left += kept * affordable_;
    clock_.end_at(of_all);
    was_idle_ = is_idle();
    if (switches::detours && was_idle_) take_detours(likely, horizon, barred, left, random);
    settle(belief.probability_of(Ending::running), horizon);
    taken_ = affordable_ - left - gains_.kept_steps();
    return 1 + static_cast<std::uint64_t>(taken_ / horizon);
  }

  const Estimates& estimates() const { return estimates_; }
  // What the best candidate is worth if nothing more is observed after it.
  double least() const { return least_; }
  // Whether all that was tried, but for detours, earns nothing and spares no regret.
  bool is_lost() const { return was_idle_; }
  // The plain plan that returns most from the states of the decision, and how much an action earns there.
  PlainPlan plain_plan(int horizon, const BarredActions& barred, Sampler& random) const {
    return PlainPlans<Model>::best(belief_, horizon, barred, of_plain * affordable_, random);
  }
  double reward_of(int action, Sampler& random) const { return PlainPlans<Model>::played(action, belief_, of_reward, 1, random).returned; }
  // Whether the world, left to itself, comes to cost more than ways earn where the state is seen. If they are followed one after
  // the other, its cost counts from where no way goes on. Ways do not tell what to do then.
  bool is_neglect_dear(int horizon, Sampler& random) {
    const double earned = belief_.mean([&](std::size_t k) { return gains_.best_in(k); });
    const double lost = PlainPlans<Model>::least_decay(belief_, horizon, earned, random);
    if (lost <= earned) return false;
    clock_.end_at(of_all);
    double left = affordable_ - taken_;
    values_.begin(belief_, horizon, tried_options, left, random);
    taken_ = affordable_ - left;
    const Followed seen = values_.mean();
    return seen.discount * lost > seen.earned;
  }
  // Lets a plain plan decide. What was told of all else is `lost` too much. Where the mission goes on after the plan it plans anew, so that half of
  // what was promised above it is told. It may return as little as the plan, and as much as the states are worth if they are seen.
  void settle_for(const PlainPlan& plain, double promised, double lost) {
    for (ActionEstimate& estimate : estimates_) estimate.q -= estimate.n > 0 ? lost : 0;
    const double above = plain.goes_on * std::max(promised - plain.returned, 0.0) / 2;
    const double open = plain.goes_on * std::max(regret_.value_seen() - plain.returned, 0.0) / 2;
    estimates_[plain.action] = {plain.returned + above, static_cast<std::uint32_t>(belief_.size()), std::hypot(plain.error, std::max(above, open))};
    reason_ = "that promises of this mission were not kept";
  }
  // Whether a way to a reward was found, in this mission, from any state.
  bool knows_ways() const { return !library_.options().empty(); }
  // Whether rewards come by themselves, so that a way to one tells nothing.
  bool earns_anyway() const { return changes_.earns_anyway(); }
  // Whether each search for ways stops at a step that changes nothing.
  bool earns_idle() const { return switches::idle_income && changes_.earns_idle(); }
  // The steps of the model that were taken since `prepare` began.
  double taken() const { return taken_; }
  // What decided, for a plan's `why`.
  const char* reason() const { return reason_; }

  void start_over() {
    is_prepared_ = false;
    obstacle_.clear();
    taken_way_.clear();
    was_idle_ = true;
    gains_ = {};
    library_.start_over();
    tests_.start_over();
  }

 private:
  using View = typename OptionMoves<Model>::View;
  static constexpr double of_states = 0.05;
  // Of the time, if the budget is one:
  static constexpr double of_gains = 0.5;  // until options are measured
  static constexpr double of_all = 0.95;   // to end what is at hand takes the rest
  static constexpr double of_plans = 0.4;      // of the time and the steps that are left
  static constexpr double of_twins = 0.1;      // of the steps that are left
  static constexpr double enough_found = 0.5;  // of the belief
  static constexpr double whole_look = 80'000;  // steps: searches at both widths from two states (docs/lab/budgets.md)
  static constexpr double matters = 1e-6;       // of the value, as a regret
  static constexpr std::size_t tried_options = 8;
  static constexpr double of_detours = 0.4;  // of the steps and the time, after a lost step
  static constexpr double of_plain = 0.05;   // of the steps, where promises were not kept, and before detours
  static constexpr std::size_t of_reward = 64;  // draws
  static constexpr std::size_t most_after = 4;  // observations that are tried after an option

  // Looks for ways from the states. Returns the weight of those with one. Where conditions can be counted, half of the time and the steps is
  // left for that, since what the first search does not find it does not find soon.
  double find_ways(double& left, Sampler& random) {
    const bool can_count = library_.can_count();
    const double kept = can_count ? left / 2 : 0;
    left -= kept;
    double found = 0;
    {
      const DecisionClock::Slice part(clock_, can_count ? clock_.left_s() / 2 : clock_.left_s());
      found = library_.extend(belief_, left, random);
    }
    left += kept;
    return found < enough_found && library_.count() ? library_.extend(belief_, left, random) : found;
  }

  // What keeps the policy from deciding in this model.
  std::string obstacle_of_model(Sampler& random) {
    double left = 0;
    clock_.end_at(of_all);
    const bool is_whole = tests_.observe_all({}, left, random);
    const bool only_changes = is_whole && tests_.empty() && tests_.moves().size() > OptionMoves<Model>::few && !sees_elsewhere(left, random);
    taken_ -= left;
    return only_changes ? "nothing is observed but by what changes the state" : "";
  }

  // Whether something can be observed after one of a few moves, as where a robot begins at a place without anything to see.
  bool sees_elsewhere(double& left, Sampler& random) {
    const List<int>& moves = tests_.moves();
    const std::size_t stride = std::max<std::size_t>(moves.size() / OptionMoves<Model>::few, 1);
    for (std::size_t i = 0; i < moves.size(); i += stride) {
      if (moves_.best_view(moves[i], {}, left, random).test >= 0) return true;
    }
    return false;
  }

  // The moves that are tried. Where all are many, those that earn nothing at once are, if they are few; then they only serve
  // to observe, and are tried with what can be observed after them.
  void choose_moves(const BarredActions& barred) {
    tried_moves_.clear();
    for (int action = 0; action < Model::action_count(); ++action) {
      if (changes_.is_move(action) && !barred.contains(action)) tried_moves_.push_back(action);
    }
    are_for_views_ = tried_moves_.size() > OptionMoves<Model>::few;
    if (are_for_views_) erase_if(tried_moves_, [this](int move) { return library_.earns_at_once(move); });
    if (tried_moves_.size() > OptionMoves<Model>::few) tried_moves_.clear();
  }

  // The options with the highest income by the belief.
  List<std::size_t> likely_options(const BarredActions& barred) const {
    List<std::pair<double, std::size_t>> incomes;
    for (std::size_t o = 0; o < gains_.size(); ++o) {
      if (barred.contains(gains_.way(o).front())) continue;
      incomes.emplace_back(income<Model>(gains_.earned(o, belief_.weights()), gains_.length(o)), o);
    }
    sort_stably(incomes, [](const auto& one, const auto& other) { return one.first > other.first; });
    List<std::size_t> options;
    for (std::size_t i = 0; i < std::min(tried_options, incomes.size()); ++i) options.push_back(incomes[i].second);
    return options;
  }

  // What can be gained by observing now can be gained after the option, too, but for what is told of the option itself, and as
  // far as as much is told there: a look into a room tells of another one where the option leads elsewhere. What is not tried
  // there counts in full. The `rest`, which is earned after the option, has to wait for it.
  double gained_after(std::size_t option, std::size_t likely, double rest, std::size_t observing, double& left, Sampler& random) {
    const double blind = regret_.value_seen() - regret_.now();
    List<std::pair<double, const OptionCandidate*>> gains;
    for (std::size_t c = 0; c < observing; ++c) {
      const OptionCandidate& candidate = candidates_[c];
      const double gain = candidate.value - candidate.discount * (blind + candidate.avoided[likely]) - (1 - candidate.discount) * rest;
      if (gain > 0) gains.emplace_back(gain, &candidate);
    }
    sort_stably(gains, [](const auto& one, const auto& other) { return one.first > other.first; });
    double gained = 0;
    for (std::size_t i = 0; i < gains.size() && gains[i].first > gained; ++i) {
      const auto& [gain, candidate] = gains[i];
      if (!switches::tests_first || i >= most_after || left <= 0 || clock_.is_over()) return gain;
      const double here = candidate->spared - candidate->avoided[likely];
      const double there = moves_.spared_after(gains_.way(option), likely, candidate->way, here, left, random);
      gained = std::max(gained, gain - candidate->discount * std::max(here - there, 0.0));
    }
    return gained;
  }

  // While the mission goes on, what can be observed is gained after the option. So of both comes first what brings more. After tests elsewhere
  // what they tell does not count again, and nothing else is known of what can be observed there.
  void add_option(std::size_t option, std::size_t likely, std::size_t observing, double& left, Sampler& random) {
    const StateWeights after = gains_.after(option, belief_.weights());
    const double goes_on = std::accumulate(after.begin(), after.end(), 0.0);
    const double rest = gains_.best(after, option);
    const double gained = gains_.is_trip(option) ? 0 : gained_after(option, likely, rest, observing, left, random);
    const double later = rest + goes_on * gained;
    const double value = gains_.earned(option, belief_.weights()) + gains_.discount(option) * later;
    candidates_.push_back({gains_.way(option).front(), value, gains_.discount(option), gains_.is_plan(option) ? "what can be observed" : "what can be earned"});
    candidates_.back().goes_on = goes_on;
    candidates_.back().error = gains_.error(option, belief_.weights());
  }

  // Notes the option that is the best candidate so far, if one is.
  void note_way(const List<std::size_t>& likely, std::size_t observing) {
    const auto best = std::ranges::max_element(candidates_, {}, &OptionCandidate::value);
    const std::size_t place = best - candidates_.begin();
    taken_way_ = place >= observing && place < candidates_.size() ? gains_.way(likely[place - observing]) : Option{};
  }

  void add_plans(const BarredActions& barred, double& left, Sampler& random) {
    const DecisionClock::Slice part(clock_, of_plans * clock_.left_s());
    double steps = of_plans * left;
    left -= steps;
    plans_.add(barred, steps, random);
    left += steps;
    regret_.weigh_again();
  }

  void add_observations(const List<std::size_t>& likely, const BarredActions& barred, double& left, Sampler& random) {
    const List<View> views = library_.counts() ? priced_views(barred, left, random) : List<View>{};
    tests_.add_to(candidates_, left, random);
    if (twins_.are_known()) regret_.set_price(std::numeric_limits<double>::infinity(), true);
    moves_.add_to(candidates_, tried_moves_, left, random);
    for (const auto& view : views) moves_.add_view(candidates_, view, left, random);
    for (const int move : tried_moves_) {
      if (are_for_views_ && !library_.counts() && left > 0 && !clock_.is_over()) moves_.add_view(candidates_, moves_.best_view(move, barred, left, random), left, random);
    }
    for (const std::size_t option : likely) {
      if (left > 0 && !clock_.is_over() && !gains_.is_plan(option) && gains_.way(option).size() > 1) {
        moves_.add_view(candidates_, moves_.best_view(gains_.way(option).front(), barred, left, random), left, random);
      }
    }
    if (twins_.are_known()) regret_.set_price(tests_.price_of_nat(regret_.value_seen(), true), true);
  }

  // The moves with what can be observed after them. The state can be found out at the price of a nat where that is cheapest.
  List<View> priced_views(const BarredActions& barred, double& left, Sampler& random) {
    List<View> views;
    double price = tests_.price_of_nat(regret_.value_seen());
    for (const int move : tried_moves_) {
      if (left <= 0 || clock_.is_over()) break;
      views.push_back(moves_.best_view(move, barred, left, random));
      const double paid = (1 - Model::discount * Model::discount) * regret_.value_seen() - views.back().reward;
      if (views.back().test >= 0) price = std::min(price, std::max(paid, 0.0) / views.back().information);
    }
    regret_.set_price(price, false);
    return views;
  }

  // Weighs detours and options by what they return if the robot waits for ever after them. Where to wait costs nothing, all else counts, too.
  void take_detours(const List<std::size_t>& likely, int horizon, const BarredActions& barred, double& left, Sampler& random) {
    const double waiting = std::min(plain_plan(horizon, barred, random).returned, 0.0);
    left -= of_plain * affordable_;
    List<OptionCandidate> found = detours_.find(tried_moves_, waiting, barred, left, random);
    if (found.empty()) return;
    waited_ = waiting;
    if (waiting < 0) candidates_.clear();
    candidates_.insert(candidates_.begin(), found.begin(), found.end());
    if (waiting == 0) return;
    for (const std::size_t option : likely) {
      candidates_.push_back({gains_.way(option).front(), detours_.returned(option, belief_.weights()), gains_.discount(option), "what can be earned"});
    }
    note_way(likely, found.size());
  }

  // Whether the best candidate earns nothing in all, and spares no regret: a lost step.
  bool is_idle() const {
    const auto best = std::ranges::max_element(candidates_, {}, &OptionCandidate::value);
    return best != candidates_.end() && best->value <= 0 && best->spared <= matters * std::abs(regret_.value_seen());
  }

  // What is told lies halfway between what the candidate is worth if nothing more is observed, and what the states are worth if they are
  // seen; where plans of tests tell the states apart, it is what these return. The same share is told of what is earned beyond the known
  // options. Half of what it costs to wait after that counts, since the work may last longer, and the mission may be ended. What may be wrong is
  // the other half, and half of what is left of the seen states' worth.
  void settle(double running, int horizon) {
    estimates_.assign(Model::action_count(), {});
    const auto most = std::ranges::max_element(candidates_, {}, &OptionCandidate::value);
    const OptionCandidate* const best = most != candidates_.end() ? &*most : nullptr;
    double later = 0;
    double error = regret_.error();
    if (best != nullptr) {
      const double seen = regret_.value_seen();
      const double left = std::max(seen - (best->value - waited_), 0.0) / 2;
      const double open = std::min(left, gains_.untested_regret(belief_.weights()) / 2);
      const double beyond = values_.beyond([this](std::size_t k) { return regret_.value_seen(k); });
      const double share = seen > 0 ? std::clamp((best->value - waited_ + open) / seen, 0.0, 1.0) : 0.5;
      const double times = seen > 0 ? 1 + std::max(beyond, 0.0) / seen : 1;
      const double waiting = waiting_cost(times, horizon) / 2;
      later = best->goes_on * (open + share * beyond - waiting) - waited_;
      error = std::hypot(best->goes_on * std::hypot(left, waiting), best->goes_on * std::max(share, 1 - share) * beyond / 2, std::hypot(error, best->error));
    }
    for (const OptionCandidate& candidate : candidates_) {
      ActionEstimate& estimate = estimates_[candidate.action];
      const double value = running * (candidate.value + later);
      if (estimate.n == 0 || value > estimate.q) estimate.q = value;
      estimate.n = belief_.size();
      estimate.standard_error = running * error;
    }
    reason_ = best != nullptr ? best->reason : "nothing";
    least_ = best != nullptr ? running * best->value : 0;
  }

  // What it costs to wait until the horizon, after `times` as many steps as the best options take.
  double waiting_cost(double times, int horizon) const {
    const double steps = std::min(times * gains_.steps_of_best(belief_.weights()), static_cast<double>(horizon));
    return values_.goes_on() * changes_.idle_cost() * (discounted_steps<Model>(horizon) - discounted_steps<Model>(steps));
  }

  bool is_prepared_ = false;
  std::string obstacle_;
  DecisionClock clock_;
  OptionLibrary<Model> library_{clock_};
  OptionGains<Model> gains_;
  double affordable_ = 0;  // steps of the model
  double taken_ = 0;       // of them, so far
  // Of the last decision:
  SampledBelief<Model> belief_;
  OptionRegret<Model> regret_{belief_, gains_};
  OwnChanges<Model> changes_;
  OptionTwins<Model> twins_{belief_, regret_, library_};
  OptionTests<Model> tests_{belief_, regret_, changes_, twins_, clock_};
  TestPlans<Model> plans_{belief_, gains_, tests_};
  OptionValues<Model> values_{library_, clock_};
  LaterCosts<Model> later_;
  OptionMoves<Model> moves_{belief_, regret_, tests_, values_, later_};
  OptionDetours<Model> detours_{belief_, gains_, clock_};
  bool was_idle_ = true;  // at the last decision; steps are kept for detours then
  OptionPairs<Model> pairs_{belief_, regret_, tests_, clock_};
  Option taken_way_;
  List<int> tried_moves_;
  bool are_for_views_ = false;
  List<OptionCandidate> candidates_;
  double waited_ = 0;  // what candidates count for waiting after them
  Estimates estimates_;
  const char* reason_ = "";
  double least_ = 0;
};

}
