// A search for ways from a state to something that is earned: a step with a reward above 0, or a goal.
//
// The search is breadth first, and goes on only from states with something new (iterated width: Lipovetzky and Geffner,
// 2012). At width 1 a value of a variable has to be new, at width 2 a pair of values. So it finds what is far away, where
// random walks do not get, in work that grows with the variables and not with the states. The state is seen, and steps
// are drawn: each way is tried again under other luck before it counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/base/stable_order.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/seen_cells.hpp"

namespace aos {

// A way of acting: actions one after the other, whatever is observed.
using Option = std::vector<int>;

// What an option earned from a state, discounted, and the probability that the mission goes on after it.
struct OptionOutcome {
  double earned = 0;
  double goes_on = 1;
};

// Takes an option from a state, which becomes the one after it.
template <class Model>
OptionOutcome taken_option(const Option& option, typename Model::State& state, Sampler& random) {
  OptionOutcome outcome;
  double discount = 1;
  for (const int action : option) {
    outcome.earned += discount * Model::step(state, action, random).reward;
    discount *= Model::discount;
    if (Model::ending(state) != Ending::running) return {outcome.earned, 0};
  }
  return outcome;
}

// What is earned in so many steps, as an income at each step.
template <class Model>
double income(double earned, std::size_t steps) {
  const double shares = Model::discount < 1 ? (1 - std::pow(Model::discount, steps)) / (1 - Model::discount) : static_cast<double>(steps);
  return earned / shares;
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
Option way_through(const std::vector<WayNode<State>>& nodes, std::uint32_t node, int action) {
  Option way{action};
  for (; node != 0; node = nodes[node].before) way.push_back(nodes[node].action);
  std::ranges::reverse(way);
  return way;
}

template <class Model>
class OptionSearch {
 public:
  using State = typename Model::State;

  OptionSearch(const LeafCells<Model>& cells, const DecisionClock& clock) : cells_(cells), clock_(clock) {}

  // The ways from a state, the best first. `steps` is counted down.
  std::vector<Option> from(const State& state, double& steps, Sampler& random) {
    std::vector<Option> found = narrow(state, steps, random);
    if (found.empty()) found = searched(state, 2, steps, random);
    return found;
  }
  // The same at width 1 only.
  std::vector<Option> narrow(const State& state, double& steps, Sampler& random) { return searched(state, 1, steps, random); }

 private:
  static constexpr double max_steps = 20'000;  // of the model, at each width
  static constexpr std::size_t max_found = 16;  // with the highest income
  static constexpr std::size_t max_dear = 16;   // of the others, that earn most
  static constexpr int tries = 4;  // of each way that was found
  static constexpr std::uint32_t asked_every = 32;  // nodes, the clock
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
  std::vector<Option> searched(const State& start, int width, double& steps, Sampler& random) {
    std::vector<Way> ways = confirmed(start, found_within(start, width, 0, steps, random), steps, random);
    if (!found_.empty() && (ways.empty() || ways.front().earned < needs_luck * ways.front().once)) {
      const std::vector<Way> longer = confirmed(start, found_within(start, width, longer_by, steps, random), steps, random);
      ways.insert(ways.end(), longer.begin(), longer.end());
      sort_stably(ways, has_more_income);
    }
    std::vector<Option> options;
    for (Way& way : ways) options.push_back(std::move(way.option));
    return options;
  }

  // The ways that are at most `longer` steps longer than the shortest one.
  const std::vector<Found>& found_within(const State& start, int width, std::uint32_t longer, double& steps, Sampler& random) {
    double limit = max_steps;
    found_.clear();
    nodes_.clear();
    seen_.clear();
    cells_before_.resize(cells_.size());
    cells_after_.resize(cells_.size());
    nodes_.push_back({start, 0, -1, 0, 0});
    note_start(start, width);
    std::uint32_t last_depth = std::numeric_limits<std::uint32_t>::max();
    for (std::uint32_t number = 0; number < nodes_.size() && limit > 0 && nodes_[number].depth <= last_depth; ++number) {
      if (number % asked_every == 0 && clock_.is_over()) break;
      cells_.write(nodes_[number].state, cells_before_.data());
      const double discount = std::pow(Model::discount, nodes_[number].depth);
      for (int action = 0; action < Model::action_count(); ++action, --limit, --steps) {
        State next = nodes_[number].state;
        const Step step = Model::step(next, action, random);
        const double earned = nodes_[number].earned + discount * step.reward;
        const Ending ending = Model::ending(next);
        if ((step.reward > 0 && ending != Ending::failure) || ending == Ending::goal) {
          found_.push_back({number, action, earned, income<Model>(earned, nodes_[number].depth + 1)});
          // What ends the mission ends with it what could have been earned a step later.
          const std::uint32_t more = ending == Ending::running ? longer : std::max(longer, later_ends);
          last_depth = std::min(last_depth, nodes_[number].depth + more);
        } else if (ending == Ending::running && is_new(next, width)) {
          nodes_.push_back({next, number, action, earned, nodes_[number].depth + 1});
        }
      }
    }
    sort_stably(found_, has_more_income);
    // Those that are no longer among the first may still earn most.
    if (found_.size() > max_found) {
      sort_stably(found_.begin() + static_cast<std::ptrdiff_t>(max_found), found_.end(), [](const Found& one, const Found& other) { return one.earned > other.earned; });
      found_.resize(std::min(found_.size(), max_found + max_dear));
    }
    return found_;
  }

  // The ways that also earn something under other luck, those with the highest income first.
  std::vector<Way> confirmed(const State& start, const std::vector<Found>& found, double& steps, Sampler& random) const {
    std::vector<Way> ways;
    for (const Found& last : found) {
      Way way{way_through(nodes_, last.node, last.action), 0, last.earned, 0};
      for (int i = 0; i < tries; ++i) {
        State state = start;
        way.earned += taken_option<Model>(way.option, state, random).earned / tries;
      }
      way.income = income<Model>(way.earned, way.option.size());
      steps -= tries * static_cast<double>(way.option.size());
      if (way.earned > 0) ways.push_back(std::move(way));
    }
    sort_stably(ways, has_more_income);
    return ways;
  }

  void note_start(const State& state, int width) {
    cells_.write(state, cells_after_.data());
    for (std::size_t i = 0; i < cells_.size(); ++i) seen_.note(cells_after_.data(), cells_.size(), i, width);
  }
  // Notes the values of a state. Returns whether it has any that no state before it had.
  bool is_new(const State& state, int width) {
    cells_.write(state, cells_after_.data());
    bool is_new = false;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (cells_after_[i] != cells_before_[i]) is_new = seen_.note(cells_after_.data(), cells_.size(), i, width) || is_new;
    }
    return is_new;
  }

  const LeafCells<Model>& cells_;
  const DecisionClock& clock_;
  std::vector<WayNode<State>> nodes_;
  std::vector<Found> found_;
  SeenCells seen_;
  std::vector<std::uint64_t> cells_before_;
  std::vector<std::uint64_t> cells_after_;
};

}  // namespace aos
