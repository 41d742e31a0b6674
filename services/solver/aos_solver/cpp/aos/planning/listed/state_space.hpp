// The model as numbers: the states that can be reached, and all outcomes of each action in each of them. The planner owns one
// space and lends it. The documents' code enumerates each pair of a state and an action once (state_lister.hpp).
#pragma once

#include "aos/base/add_up.hpp"
#include "aos/base/fault.hpp"
#include "aos/base/mixed.hpp"
#include "aos/base/progress.hpp"
#include "aos/base/statistics.hpp"
#include "aos/base/switches.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/listed/number_reports.hpp"
#include "aos/planning/listed/observation_numbers.hpp"
#include "aos/planning/listed/state_lister.hpp"
#include "aos/planning/listed/state_numbers.hpp"
#include "point_based/flat_model.hpp"

namespace aos {

// Of later tries, which hold up a mission: together with what planners prepare then they take 0.1 to 0.3 seconds.
inline constexpr ListLimits later_limits{.states = 16'000, .outcomes = 500'000, .work = 1'500'000};

// Where continuous draws are estimated: a state that holds a drawn number leads to others without end.
inline constexpr ListLimits estimate_limits{.states = 16'000, .outcomes = 3'000'000, .work = 5'000'000};

using point_based::Numbering;

// Outcomes that end the mission are left out of the rows: ended states have no number and are worth nothing.
template <class Model>
class StateSpace {
 public:
  using State = typename Model::State;

  explicit StateSpace(const ListLimits& limits = {}) : lister_(limits) {
    rows_.actions = static_cast<std::size_t>(Model::action_count());
    rows_.discount = Model::discount;
    rows_.outcomes.first.push_back(0);
    rows_.likelihoods.first.push_back(0);
  }

  // Lists what can be reached from a belief. Observations are left out if there are too many. Returns whether
  // everything is listed; otherwise `obstacle` tells why not.
  bool reach(const Belief<Model>& belief) {
    if (!switches::lists) {
      give_up("lists are switched off", belief);
      return false;
    }
    if (!obstacle_.empty() && !is_worth_another_try(belief)) return false;
    try {
      add_states_of(belief);
      while (!is_closed()) list_rows_before(size(), true);
      return true;
    } catch (const NotEnumerable& limit) {
      if (may_list_less(limit.reason)) return reach(belief);
      give_up(limit.reason, belief);
    } catch (const ModelFault& fault) {
      give_up("model code fails in a state that can be reached: " + fault.text, belief);
    }
    return false;
  }

  // Lists what `decisions` decisions can lead to from a belief. Throws NotEnumerable, or what model code throws.
  void reach_within(const Belief<Model>& belief, int decisions) {
    add_states_of(belief);
    for (; decisions > 0 && !is_closed(); --decisions) list_rows_before(size());
  }

  // Lists from a belief alone what `decisions` decisions can lead to, or as many of them as the limits allow, which are
  // `least` or more. The states behind the last of them have no outcomes and earn nothing. Returns how many decisions are
  // listed. Throws NotEnumerable, or what model code throws.
  int reach_near(const Belief<Model>& belief, int least, int decisions) {
    for (;;) {
      restart();
      int listed = 0;
      try {
        add_states_of(belief);
        for (; listed < decisions && !is_closed(); ++listed) list_rows_before(size(), true);
        const bool is_whole = is_closed();
        end_list();
        return is_whole ? std::numeric_limits<int>::max() : listed;
      } catch (const NotEnumerable&) {
        if (listed < least || listed == decisions) throw;
        decisions = listed;
      }
    }
  }
  void limit(const ListLimits& limits) { lister_.limit(limits); }

  // Begins another mission: its tries come when those of the first one came.
  void start_over() { given_up_with_ = first_given_up_with_; }

  const std::string& obstacle() const { return obstacle_; }
  // Code that keeps numbers of states compares numberings before it uses these again.
  Numbering numbering() const { return {restarts_, size()}; }
  std::size_t size() const { return lister_.numbers().size(); }
  std::size_t actions() const { return rows_.actions; }
  State operator[](std::uint32_t number) const { return lister_.numbers()[number]; }
  // The number of a state; `no_state` if it has ended or cannot be reached.
  std::uint32_t find(const State& state) const {
    return Model::ending(state) == Ending::running ? lister_.numbers().find(state) : no_state;
  }
  // Whether every state has its rows.
  bool is_closed() const { return listed_ == size(); }
  // Rewards and outcomes by state and action, without starts.
  const point_based::FlatModel& rows() const { return rows_; }
  const ObservationNumbers<Model>& observations() const { return observations_; }
  // Whether the observations of the rows are those of the robot. In a model that reports numbers they are reports.
  bool lists_observations() const { return !Model::reports_numbers() && !skips_sensing_; }
  // Whether the rows have no observations, and why.
  bool leaves_out_observations() const { return skips_sensing_; }
  const std::string& observations_obstacle() const { return observations_obstacle_; }
  // Whether continuous draws stand in the rows by a few numbers each. Nothing that is told of them is proven then.
  bool estimates_draws() const { return strata_.count > 0; }
  // What is listed, for a plan's `why`.
  std::string listed_text() const {
    const std::string states = size() == 1 ? "the only state can be listed" : "all " + std::to_string(size()) + " states can be listed";
    return estimates_draws() ? states + ", and each continuous draw stands for " + std::to_string(strata_.count) + " numbers" : states;
  }
  // How far a value of `horizon` decisions may be off by that: the error of a probability may earn the largest reward or not.
  double error_of_draws(int horizon) const { return estimates_draws() ? strata_.error() * most_earned(horizon) : 0; }
  // How far bounds of the value of `horizon` decisions have to be widened, since the belief is not quite the exact one and
  // rows leave out improbable rounds of loops. No decision is taken to earn more than the largest expected reward. A
  // drawn belief has no bound, so its bounds are those of its particles. Where draws are estimated there are no bounds.
  double slack(const Belief<Model>& belief, int horizon) const {
    if (estimates_draws()) return std::numeric_limits<double>::infinity();
    const double wrong = belief.is_drawn() ? 0 : belief.error_bound();
    if (wrong <= 0 && lister_.most_left_out() <= 0) return 0;
    return (2 * wrong + horizon * lister_.most_left_out()) * most_earned(horizon);
  }
  const NumberReports& reports() const { return reports_; }
  bool reaches(Ending ending) const { return lister_.reaches(ending); }

  // The running part of a belief, by ascending numbers. The weights are not normalised.
  List<std::pair<std::uint32_t, double>> weights_of(const Belief<Model>& belief) const {
    List<std::pair<std::uint32_t, double>> weights;
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) == Ending::running) weights.emplace_back(lister_.numbers().find(state), weight);
    }
    std::sort(weights.begin(), weights.end());
    add_up_neighbours(weights, &std::pair<std::uint32_t, double>::first, &std::pair<std::uint32_t, double>::second);
    return weights;
  }
  // Why the belief has no exact values; null if it has.
  const char* inexact_text(const Belief<Model>& belief) const {
    if (!lists_observations()) return numbers_are_observed;
    if (estimates_draws()) return "draws are continuous";
    return belief.is_exact() ? nullptr : "the belief is only known by samples";
  }
  // The same as `weights_of`. Throws NotEnumerable where the belief has no exact values.
  List<std::pair<std::uint32_t, double>> exact_weights_of(const Belief<Model>& belief) const {
    if (const char* const why = inexact_text(belief)) throw NotEnumerable{why};
    return weights_of(belief);
  }

 private:
  // The largest expected reward, earned at each decision.
  double most_earned(int horizon) const {
    double decisions = 0;
    for (int left = 0; left < horizon; ++left) decisions = 1 + Model::discount * decisions;
    return largest_size(rows_.rewards) * decisions;
  }

  static constexpr std::uint32_t fewest_priced = 16;  // states
  static constexpr double far_more = 4;  // times the limit

  using SensingKey = List<std::uint64_t>;  // of observations with their probabilities
  // A path through an action after which the mission goes on.
  struct Path {
    std::uint32_t next;
    std::uint32_t observation;
    double probability;
  };

  void restart() {
    blame::at(0);
    const std::uint64_t restarts = restarts_ + 1;
    const std::size_t first_given_up_with = first_given_up_with_;
    *this = StateSpace{lister_.limits()};
    restarts_ = restarts;
    first_given_up_with_ = first_given_up_with;
  }
  // A belief of half as many states may lead to few enough.
  bool is_worth_another_try(const Belief<Model>& belief) const {
    return 2 * belief.particles().size() <= given_up_with_;
  }
  // Prepares another try, where it may help to leave out what is observed, or to estimate draws more and more coarsely.
  bool may_list_less(const char* why) {
    const bool may_skip = lister_.draws().meets_sensing() && !skips_sensing_;
    if (!estimates_draws()) {
      if (may_skip) return list_anew(DrawStrata{}, why);
      return switches::estimated_draws && lister_.draws().meets_number() && list_anew(DrawStrata::of(fine_strata), nullptr);
    }
    if (size() > lister_.limits().states) return false;
    const DrawStrata coarser = strata_.coarser();
    if (coarser.count > 0) return list_anew(coarser, skips_sensing_ ? observations_obstacle_.c_str() : nullptr);
    return may_skip && list_anew(DrawStrata::of(fine_strata), why);
  }
  // Begins a list with these strata of draws, and without what is observed where there is a reason.
  bool list_anew(DrawStrata strata, const char* why_without_observations) {
    const std::string why = why_without_observations != nullptr ? why_without_observations : "";
    restart();
    strata_ = strata;
    lister_.draws().divide_numbers(strata);
    if (estimates_draws()) limit(smaller(lister_.limits(), estimate_limits));
    skips_sensing_ = !why.empty();
    observations_obstacle_ = why;
    lister_.draws().skip_sensing(skips_sensing_);
    return true;
  }
  void give_up(std::string why, const Belief<Model>& belief) {
    restart();
    obstacle_ = std::move(why);
    given_up_with_ = belief.particles().size();
    if (first_given_up_with_ == 0) first_given_up_with_ = given_up_with_;
    limit(smaller(lister_.limits(), later_limits));
  }
  static ListLimits smaller(const ListLimits& one, const ListLimits& other) {
    return {std::min(one.states, other.states), std::min(one.bytes, other.bytes), std::min(one.outcomes, other.outcomes),
            std::min(one.work, other.work)};
  }

  void add_states_of(const Belief<Model>& belief) {
    obstacle_.clear();
    lister_.add_states_of(belief);
  }

  // With `gives_up` a list ends before the limit if the later half of what is listed took so much work that the rest will take
  // far more: to find that out at the limit takes seconds.
  void list_rows_before(std::size_t end, bool gives_up = false) {
    if (reports_numbers_) lister_.draws().report_to(&reports_);
    std::size_t work = lister_.work();
    for (const std::uint32_t first = listed_; listed_ < end; ++listed_) {
      if (listed_ % states_between_looks == 0) progress::tell("listing states", listed_, size());
      const State state = (*this)[listed_];
      for (std::size_t action = 0; action < rows_.actions; ++action) add_row(state, static_cast<int>(action));
      const std::uint32_t done = listed_ - first + 1;
      if (!std::has_single_bit(done)) continue;
      const auto of_half = static_cast<double>(lister_.work() - std::exchange(work, lister_.work()));
      const double expected = 2 * of_half / done * static_cast<double>(end - listed_);
      if (!gives_up || done < fewest_priced || estimates_draws() || expected < far_more * static_cast<double>(lister_.limits().work)) continue;
      throw NotEnumerable{"there are too many outcomes to list"};
    }
    rows_.states = listed_;
    rows_.observations = skips_sensing_ ? 1 : reports_numbers_ ? reports_.reports().size() : observations_.size();
  }

  void end_list() {
    for (; listed_ < size(); ++listed_) {
      rows_.rewards.resize(rows_.rewards.size() + rows_.actions);
      rows_.outcomes.first.resize(rows_.outcomes.first.size() + rows_.actions, rows_.outcomes.elements.size());
    }
    rows_.states = listed_;
  }

  void add_row(const State& state, int action) {
    paths_.clear();
    rows_.rewards.push_back(lister_.walk(state, action, [&](const State& next, const Step& step, double probability) {
      paths_.push_back({lister_.add(next), observation_of(action, step), probability});
    }));
    add_outcomes();
    rows_.outcomes.first.push_back(rows_.outcomes.elements.size());
    if (std::max(rows_.outcomes.elements.size(), rows_.likelihoods.elements.size()) > lister_.limits().outcomes) {
      throw NotEnumerable{"there are too many outcomes to list"};
    }
  }

  std::uint32_t observation_of(int action, const Step& step) {
    if (skips_sensing_) return 0;
    // Of texts of drawn numbers only a few would be known.
    if (step.observation < default_observation && lister_.draws().has_drawn_number()) throw NotEnumerable{"what is observed are texts"};
    const int skill = Model::skill_of(action);
    const std::uint32_t number = observations_.add(skill, step.observation);
    return reports_numbers_ ? reports_.add(skill, number) : number;
  }

  void add_outcomes() {
    std::sort(paths_.begin(), paths_.end(), [](const Path& left, const Path& right) {
      return std::tie(left.next, left.observation) < std::tie(right.next, right.observation);
    });
    for (std::size_t first = 0; first < paths_.size();) {
      std::size_t last = first;
      double probability = 0;
      for (; last < paths_.size() && paths_[last].next == paths_[first].next; ++last) probability += paths_[last].probability;
      rows_.outcomes.elements.push_back({paths_[first].next, sensing_of(first, last, probability), probability});
      first = last;
    }
  }

  // The sensing of paths with the same next state. Most sensings have been met before.
  std::uint32_t sensing_of(std::size_t first, std::size_t last, double total) {
    constexpr double unit = 0x1p51;  // differences below 1 / unit come from rounding
    likelihoods_.clear();
    key_.clear();
    for (std::size_t i = first; i < last; ++i) likelihoods_.push_back({paths_[i].observation, paths_[i].probability / total});
    add_up_neighbours(likelihoods_, &point_based::Likelihood::observation, &point_based::Likelihood::probability);
    for (const auto& [observation, probability] : likelihoods_) {
      key_.push_back(observation);
      key_.push_back(static_cast<std::uint64_t>(std::llround(unit * probability)));
    }
    const auto [entry, is_new] = sensings_.try_emplace(key_, static_cast<std::uint32_t>(sensings_.size()));
    if (is_new) {
      rows_.likelihoods.elements.insert(rows_.likelihoods.elements.end(), likelihoods_.begin(), likelihoods_.end());
      rows_.likelihoods.first.push_back(rows_.likelihoods.elements.size());
    }
    return entry->second;
  }

  StateLister<Model> lister_;
  ObservationNumbers<Model> observations_;
  bool reports_numbers_ = Model::reports_numbers();
  NumberReports reports_;
  point_based::FlatModel rows_;
  std::uint32_t listed_ = 0;  // how many states have their rows
  std::uint64_t restarts_ = 0;
  bool skips_sensing_ = false;
  DrawStrata strata_;  // by which continuous draws are estimated
  std::string observations_obstacle_;
  std::string obstacle_;
  std::size_t given_up_with_ = 0;        // how many states the belief had
  std::size_t first_given_up_with_ = 0;  // in the first try

  std::unordered_map<SensingKey, std::uint32_t, NumbersHash> sensings_;
  List<Path> paths_;
  List<point_based::Likelihood> likelihoods_;
  SensingKey key_;
};

}
