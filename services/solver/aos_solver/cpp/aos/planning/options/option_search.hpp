// A search for ways from a state to something that is earned: a step with a reward above 0. A goal that pays nothing is none.
//
// The search is breadth first, and goes on only from states with something new (iterated width: Lipovetzky and Geffner,
// 2012). At width 1 a value of a variable has to be new, at width 2 a pair of values. So it finds what is far away, where
// random walks do not get, in work that grows with the variables and not with the states. The state is seen, and steps
// are drawn: each way is tried again under other luck before it counts.
//
// Where a reward asks for many conditions at once, no value and no pair of values tells the way. Then it is searched best
// first, and what is new is so among states in which as many conditions hold (best-first width search: Lipovetzky and Geffner, 2017).
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/running_down.hpp"
#include "aos/planning/values/seen_cells.hpp"

namespace aos {

// A way of acting: actions one after the other, whatever is observed.
using Option = List<int>;

// Adds an option, and what is left of it after its first actions, as far as they are new: at most `most` of it, and up to `limit` in all.
inline void add_with_rests(List<Option>& options, const Option& option, std::size_t most, std::size_t limit) {
  for (std::size_t first = 0; first < std::min(most, option.size()) && options.size() < limit; ++first) {
    Option rest(option.begin() + first, option.end());
    if (std::ranges::find(options, rest) == options.end()) options.push_back(std::move(rest));
  }
}

// What an option earned from a state, discounted, the probability that the mission goes on after it, and what its last action earned,
// not discounted.
struct OptionOutcome {
  double earned = 0;
  double goes_on = 1;
  double last = 0;
};

// How often an action of an option is taken that changes nothing, as a grip that slips, where a way has many of them.
inline constexpr int most_attempts = 4;

// Takes an action, and where nothing has changed but what runs down takes it again, if it changes something then. Returns what was
// earned. `discount` is that of the next step.
template <class Model>
double attempted(int action, typename Model::State& state, double& discount, Sampler& random, const RunningDown<Model>& running_down) {
  const typename Model::State before = state;
  const Xoshiro drawn = random;
  const double first = discount * Model::step(state, action, random).reward;
  discount *= Model::discount;
  // Without a draw the same comes again.
  if (drawn == random && are_alike<Model>(before, state)) return first;
  const auto has_changed = [&](const typename Model::State& next) { return Model::ending(next) != Ending::running || running_down.differ(before, next); };
  if (has_changed(state)) return first;
  typename Model::State next = state;
  double earned = first;
  double now = discount;
  for (int attempt = 1; attempt < most_attempts; ++attempt) {
    earned += now * Model::step(next, action, random).reward;
    now *= Model::discount;
    if (!has_changed(next)) continue;
    discount = now;
    state = std::move(next);
    return earned;
  }
  return first;
}

// Takes an option from a state, which becomes the one after it. With `retries` an action that changes nothing is taken again.
template <class Model>
OptionOutcome taken_option(const Option& option, typename Model::State& state, Sampler& random, const RunningDown<Model>* retries) {
  OptionOutcome outcome;
  double discount = 1;
  for (const int action : option) {
    const double first = discount;
    double earned = 0;
    if (retries != nullptr) {
      earned = attempted<Model>(action, state, discount, random, *retries);
    } else {
      earned = discount * Model::step(state, action, random).reward;
      discount *= Model::discount;
    }
    outcome.earned += earned;
    outcome.last = earned / first;
    if (Model::ending(state) != Ending::running) {
      outcome.goes_on = 0;
      break;
    }
  }
  return outcome;
}

// What so many steps return that earn 1 each.
template <class Model>
double discounted_steps(double steps) {
  return Model::discount < 1 ? (1 - std::pow(Model::discount, steps)) / (1 - Model::discount) : steps;
}

// What is earned in so many steps, as an income at each step.
template <class Model>
double income(double earned, double steps) {
  return earned / discounted_steps<Model>(steps);
}

// A state that a search for ways has come to: the node before it, the action from there, and what was earned since the start.
template <class State>
struct WayNode {
  State state;
  std::uint32_t before;
  int action;
  double earned;
  std::uint32_t depth;
};

// The actions from the start, which is node 0, to a node, and one more.
template <class State>
Option way_through(const List<WayNode<State>>& nodes, std::uint32_t node, int action) {
  Option way{action};
  for (; node != 0; node = nodes[node].before) way.push_back(nodes[node].action);
  std::ranges::reverse(way);
  return way;
}

template <class Model>
class OptionSearch {
 public:
  using State = typename Model::State;

  // `counts`: the conditions of rewards and goals that hold, before pairs of values are tried.
  OptionSearch(const LeafCells<Model>& cells, const DecisionClock& clock, const RunningDown<Model>* retries, bool counts)
      : cells_(cells), clock_(clock), retries_(retries), counts_(counts) {}

  // The ways from a state, the best first. `steps` is counted down.
  List<Option> from(const State& state, double& steps, Sampler& random) {
    List<Option> found = counts_ ? options_of(confirmed(state, found_by_conditions(state, steps, random), steps, random))
                                        : narrow(state, steps, random);
    if (found.empty()) found = searched(state, 2, steps, random);
    return found;
  }
  // The same at width 1 only.
  List<Option> narrow(const State& state, double& steps, Sampler& random) { return searched(state, 1, steps, random); }
  // The same at width 3 only: to carry something on a map needs both coordinates with what is carried.
  List<Option> wide(const State& state, double& steps, Sampler& random) { return searched(state, 3, steps, random); }
  // The ways from a state after which the mission goes on, the best first. No conditions are counted.
  List<Option> past_ends(const State& state, double& steps, Sampler& random) {
    passes_ends_ = true;
    return from(state, steps, random);
  }

 private:
  static constexpr double max_steps = 20'000;  // of the model, at each width
  static constexpr std::size_t max_found = 16;  // with the highest income
  static constexpr std::size_t max_dear = 16;   // of the others, that earn most
  static constexpr int tries = 4;  // of each way that was found
  static constexpr std::uint32_t asked_every = 32;  // nodes, the clock
  static constexpr int most_rounds = 3;  // through the states of one search
  static constexpr double of_triple = 0.02;  // of a step of the model, to note what three variables are together
  static constexpr double needs_luck = 0.9;
  static constexpr std::uint32_t longer_by = 2;
  static constexpr std::uint32_t later_ends = 1;

  struct Found {
    std::uint32_t node;
    int action;
    double earned;
    double income;
  };
  struct Way {
    Option option;
    double earned;  // on average
    double once;    // when it was found
    double income;
  };
  static constexpr auto has_more_income = [](const auto& one, const auto& other) { return one.income > other.income; };

  // The shortest ways are found first. Where they have needed luck, longer ones are tried, too.
  List<Option> searched(const State& start, int width, double& steps, Sampler& random) {
    List<Way> ways = confirmed(start, found_within(start, width, 0, steps, random), steps, random);
    if (!found_.empty() && (ways.empty() || ways.front().earned < needs_luck * ways.front().once)) {
      const List<Way> longer = confirmed(start, found_within(start, width, longer_by, steps, random), steps, random);
      ways.insert(ways.end(), longer.begin(), longer.end());
      sort_stably(ways, has_more_income);
    }
    return options_of(ways);
  }
  static List<Option> options_of(const List<Way>& ways) {
    List<Option> options;
    for (const Way& way : ways) options.push_back(way.option);
    return options;
  }

  // The ways that are at most `longer` steps longer than the shortest one.
  const List<Found>& found_within(const State& start, int width, std::uint32_t longer, double& steps, Sampler& random) {
    double limit = max_steps;
    const double step = width < 3 ? 1 : 1 + of_triple * static_cast<double>(cells_.size() * cells_.size());
    begin(start);
    seen_.clear();
    note_all(start, seen_, width);
    std::uint32_t last_depth = std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t number = 0; number < nodes_.size() && limit > 0 && nodes_[number].depth <= last_depth; ++number) {
      if (number % asked_every == 0 && clock_.is_over()) break;
      cells_.write(nodes_[number].state, cells_before_.data());
      const double discount = std::pow(Model::discount, nodes_[number].depth);
      for (int action = 0; action < Model::action_count(); ++action, limit -= step, steps -= step) {
        WayNode<State> next = next_to(number, action);
        const bool earns = take(next, discount, random);
        const bool goes_on = Model::ending(next.state) == Ending::running;
        if (earns) {
          // What ends the mission ends with it what could have been earned a step later.
          const std::uint32_t more = goes_on ? longer : std::max(longer, later_ends);
          last_depth = std::min(last_depth, nodes_[number].depth + more);
        } else if (goes_on && !are_alike<Model>(next.state, nodes_[number].state) && is_new(next.state, width)) {
          nodes_.push_back(std::move(next));
        }
      }
    }
    return best_found();
  }

  // The ways that are found first if states in which more conditions hold come first, and of these those with a new value before those with
  // a new pair of values.
  const List<Found>& found_by_conditions(const State& start, double& steps, Sampler& random) {
    double limit = max_steps;
    begin(start);
    std::map<int, SeenBits> seen;  // by how many conditions hold
    std::priority_queue<std::tuple<int, int, std::int64_t>> open;  // conditions that hold, -width, -node
    List<int> met{Model::conditions_met(start)};
    for (const int width : {1, 2}) note_all(start, seen[met.front()], width);
    open.emplace(met.front(), 0, 0);
    int rounds = 1;
    for (std::uint32_t expanded = 0; !open.empty() && found_.empty() && limit > 0; ++expanded) {
      if (expanded % asked_every == 0 && clock_.is_over()) break;
      const auto number = static_cast<std::uint32_t>(-std::get<2>(open.top()));
      open.pop();
      cells_.write(nodes_[number].state, cells_before_.data());
      const double discount = std::pow(Model::discount, nodes_[number].depth);
      for (int action = 0; action < Model::action_count(); ++action, --limit, --steps) {
        WayNode<State> next = next_to(number, action);
        if (take(next, discount, random) || Model::ending(next.state) != Ending::running) continue;
        const int holding = Model::conditions_met(next.state);
        const int width = width_of(next.state, seen[holding], holding != met[number]);
        if (width > 2) continue;
        open.emplace(holding, -width, -static_cast<std::int64_t>(nodes_.size()));
        met.push_back(holding);
        nodes_.push_back(std::move(next));
      }
      // What has failed for want of luck may go well at another try.
      if (open.empty() && rounds++ < most_rounds) {
        for (std::size_t again = 0; again < nodes_.size(); ++again) open.emplace(met[again], 0, -static_cast<std::int64_t>(again));
      }
    }
    return best_found();
  }

  void begin(const State& start) {
    found_.clear();
    nodes_.clear();
    cells_before_.resize(cells_.size());
    cells_after_.resize(cells_.size());
    nodes_.push_back({start, 0, -1, 0, 0});
  }

  // The node after an action that has not been taken yet.
  WayNode<State> next_to(std::uint32_t number, int action) const {
    const WayNode<State>& before = nodes_[number];
    return {before.state, number, action, before.earned, before.depth + 1};
  }
  // Takes the action of a node. Returns whether something is earned, which is noted as a way.
  bool take(WayNode<State>& node, double discount, Sampler& random) {
    const Step step = Model::step(node.state, node.action, random);
    node.earned += discount * step.reward;
    const Ending ending = Model::ending(node.state);
    const bool earns = step.reward > 0 && (passes_ends_ ? ending == Ending::running : ending != Ending::failure);
    if (earns) found_.push_back({node.before, node.action, node.earned, income<Model>(node.earned, node.depth)});
    return earns;
  }

  const List<Found>& best_found() {
    sort_stably(found_, has_more_income);
    // Those that are no longer among the first may still earn most.
    if (found_.size() > max_found) {
      sort_stably(found_.begin() + max_found, found_.end(), [](const Found& one, const Found& other) { return one.earned > other.earned; });
      found_.resize(std::min(found_.size(), max_found + max_dear));
    }
    return found_;
  }

  // The ways that also earn something under other luck, those with the highest income first.
  List<Way> confirmed(const State& start, const List<Found>& found, double& steps, Sampler& random) const {
    List<Way> ways;
    for (const Found& last : found) {
      Way way{way_through(nodes_, last.node, last.action), 0, last.earned, 0};
      for (int i = 0; i < tries; ++i) {
        State state = start;
        way.earned += taken_option<Model>(way.option, state, random, retries_).earned / tries;
      }
      way.income = income<Model>(way.earned, way.option.size());
      steps -= tries * static_cast<double>(way.option.size());
      if (way.earned > 0) ways.push_back(std::move(way));
    }
    sort_stably(ways, has_more_income);
    return ways;
  }

  void note_all(const State& state, auto& seen, int width) {
    cells_.write(state, cells_after_.data());
    note_cells(seen, cells_after_.data(), cells_.size(), width, [](std::size_t) { return true; });
  }
  // Notes the values of a state. Returns whether it has any that no state before it had.
  bool is_new(const State& state, int width) {
    cells_.write(state, cells_after_.data());
    return is_new_among(seen_, width, false);
  }
  // Whether a value of the state is new, or else a pair of values: 1 or 2; 3 if neither is. `all` of its values are looked at, or
  // those that have changed.
  int width_of(const State& state, SeenBits& seen, bool all) {
    cells_.write(state, cells_after_.data());
    const bool has_new_value = is_new_among(seen, 1, all);
    const bool has_new_pair = is_new_among(seen, 2, all);
    return has_new_value ? 1 : has_new_pair ? 2 : 3;
  }
  bool is_new_among(auto& seen, int width, bool all) {
    return note_cells(seen, cells_after_.data(), cells_.size(), width, [&](std::size_t i) { return all || cells_after_[i] != cells_before_[i]; });
  }

  const LeafCells<Model>& cells_;
  const DecisionClock& clock_;
  const RunningDown<Model>* retries_;
  bool counts_;
  bool passes_ends_ = false;
  List<WayNode<State>> nodes_;
  List<Found> found_;
  SeenCells seen_;
  List<std::uint64_t> cells_before_;
  List<std::uint64_t> cells_after_;
};

}
