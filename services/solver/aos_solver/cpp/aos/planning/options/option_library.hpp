// The options that are known. They are found by searches from states of the belief, and kept from decision to decision.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/planning/backoff.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/own_changes.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/values/leaf_cells.hpp"

namespace aos {

template <class Model>
class OptionLibrary {
 public:
  using State = typename Model::State;

  explicit OptionLibrary(const DecisionClock& clock) : clock_(clock) {}

  const List<Option>& options() const { return options_; }
  const LeafCells<Model>& cells() const { return cells_; }
  // Those by which searches for ways tell what is new.
  const LeafCells<Model>& searched_cells() const { return searched_cells_; }
  // Whether ways are found only by how many conditions of rewards and goals hold.
  bool counts() const { return counts_; }
  const RunningDown<Model>& running_down() const { return running_down_; }
  // The same, where an action of a way is taken again that changes nothing else.
  const RunningDown<Model>* retries() const { return switches::retries ? &running_down_ : nullptr; }
  // Whether rewards and goals have conditions, which are not counted yet.
  bool can_count() const { return switches::goal_conditions && Model::has_goal_conditions && !counts_; }
  // Counts conditions from now on, where there are any. Returns whether that is new.
  bool count() {
    const bool is_new = can_count();
    counts_ = counts_ || is_new;
    return is_new;
  }
  const DecisionClock& clock() const { return clock_; }
  // Whether the action alone is an option: it earns something at once in some state.
  bool earns_at_once(int action) const { return std::ranges::find(options_, Option{action}) != options_.end(); }

  // Begins a mission.
  void start_over() {
    counts_ = false;
    past_ends_ = Backoff{};
    widely_ = Backoff{};
  }
  // Forgets all options, and finds what variables the missions of this belief change.
  void prepare(const Belief<Model>& belief, Sampler& random) {
    options_.clear();
    cells_.prepare(belief, random);
    moving_ = cells_.size();
    searched_cells_ = cells_.with_resting();
    own_cells_ = searched_cells_;
    running_down_.find(belief, random);
  }

  // Lets searches look first for ways by what the robot changes, and not by what changes by itself.
  void look_first_at_own(const OwnChanges<Model>& changes) {
    own_cells_ = searched_cells_.without([&](std::size_t variable) { return variable < moving_ && changes.is_worlds(variable); });
  }

  // Adds options for states from which the known ones lead to nothing, or not to the end. Returns the share of the states
  // with an option, by weight, among those that were looked at before the steps or the time were over. `steps` is counted down.
  double extend(const SampledBelief<Model>& belief, double& steps, Sampler& random) {
    double found = 0;
    double looked_at = 0;
    List<State> rests;
    List<State> ended;  // by the first option that was taken
    List<std::size_t> open;  // states without a way
    for (std::size_t k = 0; k < belief.size() && is_left(steps); ++k) {
      looked_at += belief.weights()[k];
      State state = belief.states()[k];
      std::size_t followed = counts_ ? 0 : follow(state, steps, random);
      bool has_way = followed > 0;
      if (!has_way && is_left(steps) && add_from(state, steps, random)) {
        followed = counts_ ? 0 : follow(state, steps, random);
        has_way = counts_ || followed > 0 || !is_left(steps);
      }
      if (!has_way) {
        open.push_back(k);
        continue;
      }
      found += belief.weights()[k];
      if (!counts_ && Model::ending(state) == Ending::running) rests.push_back(state);
      else if (followed == 1) ended.push_back(belief.states()[k]);
    }
    if (switches::wide_ways && !counts_) found += extend_widely(belief, open, steps, random);
    if (switches::past_ends) extend_past_ends(ended, steps, random);
    const std::size_t stride = std::max<std::size_t>(rests.size() / searched_rests, 1);
    for (std::size_t i = 0; i < rests.size(); i += stride) {
      State& rest = rests[i];
      while (is_left(steps) && Model::ending(rest) == Ending::running && add(ways_by([&](OptionSearch<Model> search) { return search.narrow(rest, steps, random); }, false), max_options)) {
        if (follow(rest, steps, random) == 0) break;
      }
    }
    return looked_at > 0 ? found / looked_at : 0;
  }

  // Adds ways from the first of the states from which one is found within so many steps, however long they take.
  void find_any(const List<State>& states, double steps, Sampler& random) {
    for (std::size_t k = 0; k < states.size() && options_.empty() && steps > 0; ++k) add_from(states[k], steps, random);
  }

  // Drops what was never among the best since the gains were measured, where options are many. Ways that were searched for by
  // conditions lead from few states, and to find them again takes less than to try them from others. The one that was `taken` stays,
  // with what is left of it, so that the robot goes on by it if no better one is found.
  void drop_unused(const OptionGains<Model>& gains, const Option& taken) {
    if (counts_) {
      options_.clear();
      if (switches::kept_ways && !taken.empty()) add({taken}, 2);
    }
    if (options_.size() <= many_options) return;
    List<Option> used;
    for (std::size_t o = 0; o < std::min(gains.size(), options_.size()); ++o) {
      if (gains.is_used(o)) used.push_back(std::move(options_[o]));
    }
    options_.clear();
    add(used, max_options);
  }

 private:
  static constexpr std::size_t max_options = 256;
  static constexpr std::size_t many_options = 64;
  static constexpr std::size_t searched_rests = 8;  // states where the known options end
  static constexpr double of_past_ends = 0.25;      // of the steps that are left
  static constexpr double of_wide_ways = 0.5;       // the same
  static constexpr std::size_t longest = 40;        // options in a row

  bool is_left(double steps) const { return steps > 0 && !clock_.is_over(); }

  // What `look` finds with a search that leaves out what the world changes by itself, or else with one that does not.
  List<Option> ways_by(auto&& look, bool counts) const {
    List<Option> ways = look(OptionSearch<Model>{own_cells_, clock_, retries(), counts});
    if (ways.empty() && own_cells_.size() < searched_cells_.size()) ways = look(OptionSearch<Model>{searched_cells_, clock_, retries(), counts});
    return ways;
  }

  // The same for those from a state. Of ways that were searched for by conditions no rests are added.
  bool add_from(const State& state, double& steps, Sampler& random) {
    return add(ways_by([&](OptionSearch<Model> search) { return search.from(state, steps, random); }, counts_), counts_ ? 1 : max_options);
  }

  // An end that pays hides what can be earned before it, as each search stops at the first reward. From some of the states where that happens ways are
  // searched for that go on.
  void extend_past_ends(const List<State>& ended, double& steps, Sampler& random) {
    if (ended.empty() || !past_ends_.is_due()) return;
    double left = of_past_ends * steps;
    steps -= left;
    const std::size_t known = options_.size();
    const std::size_t stride = std::max<std::size_t>(ended.size() / searched_rests, 1);
    for (std::size_t i = 0; i < ended.size() && is_left(left); i += stride) {
      add(ways_by([&](OptionSearch<Model> search) { return search.past_ends(ended[i], left, random); }, false), max_options);
    }
    steps += left;
    if (options_.size() > known) past_ends_.succeed();
    else past_ends_.fail();
  }

  // From states without a way wider searches are made, while that finds ways. Returns the weight of those that have one then.
  double extend_widely(const SampledBelief<Model>& belief, const List<std::size_t>& open, double& steps, Sampler& random) {
    if (open.empty() || !is_left(steps) || !widely_.is_due()) return 0;
    double left = of_wide_ways * steps;
    steps -= left;
    double found = 0;
    for (const std::size_t k : open) {
      State state = belief.states()[k];
      bool has_way = follow(state, left, random) > 0;
      if (!has_way && is_left(left)) has_way = add(ways_by([&](OptionSearch<Model> search) { return search.wide(state, left, random); }, false), max_options);
      found += has_way ? belief.weights()[k] : 0;
    }
    steps += left;
    if (found > 0) widely_.succeed();
    else widely_.fail();
    return found;
  }

  // Adds options, and what is left of each after its first actions: at most so many for each. Returns whether there were any.
  bool add(const List<Option>& found, std::size_t most) {
    for (const Option& option : found) add_with_rests(options_, option, most, max_options);
    return !found.empty();
  }

  // Takes options that earn something, the best first, until none is left, and notes what they change. Returns how many there were.
  std::size_t follow(State& state, double& steps, Sampler& random) {
    std::size_t followed = 0;
    for (std::size_t i = 0; i < longest && Model::ending(state) == Ending::running && is_left(steps); ++i) {
      const Option* best = nullptr;
      double most = 0;
      for (const Option& option : options_) {
        State next = state;
        const double earned = income<Model>(taken_option<Model>(option, next, random, retries()).earned, option.size());
        steps -= option.size();
        if (earned <= most) continue;
        most = earned;
        best = &option;
      }
      if (best == nullptr) break;
      ++followed;
      const State before = state;
      taken_option<Model>(*best, state, random, retries());
      if (switches::moved_by_ways) cells_.add_moved(before, state);
    }
    return followed;
  }

  const DecisionClock& clock_;
  LeafCells<Model> cells_;
  LeafCells<Model> searched_cells_;
  LeafCells<Model> own_cells_;  // without what the world changes by itself
  std::size_t moving_ = 0;      // of the searched variables, the first ones, which random walks change
  RunningDown<Model> running_down_;
  List<Option> options_;
  bool counts_ = false;
  Backoff past_ends_;
  Backoff widely_;
};

}
