// A search for ways from a state to something that is saved: rows of actions that return more than to rest as long, counted
// with what the states are worth to a robot that does not plan from then on (rest_values.hpp).
//
// Way and rest have the same luck at each step. The search is breadth first, and goes on only from states with something
// new that the last action has brought about, and that the world does not do by itself (own_changes.hpp; iterated width: Lipovetzky and Geffner, 2012).
#pragma once

#include "aos/base/stable_order.hpp"
#include "aos/planning/earned.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/own_changes.hpp"
#include "aos/planning/savings/rest_values.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/seen_cells.hpp"

namespace aos {

// What a state returns while the robot rests, and what it is worth after so many steps, and as many more as settle a way.
template <class Model>
class Rest {
 public:
  using State = typename Model::State;

  Rest(const RestValues<Model>& values, State state, std::size_t steps, const StepLuck& luck) {
    Earned<Model> earned;
    for (std::size_t step = 0;; ++step) {
      returned_.push_back(earned.sum + earned.discount * values.value(state));
      if (step == steps + values.settling()) break;
      Sampler random = luck.of(step);
      earned.add(Model::ending(state) == Ending::running ? Model::step(state, values.action(), random).reward : 0);
    }
  }
  double returned(std::size_t steps) const { return returned_[steps]; }

 private:
  List<double> returned_;  // by how many steps are taken before states are valued
};

// What is returned by a way and by the rests after it, and what the state is worth then. So much was earned in `taken` steps before.
template <class Model>
double returned_along(const RestValues<Model>& values, const Option& way, typename Model::State state, const StepLuck& luck, double earned = 0, std::size_t taken = 0) {
  const auto take = [&](std::size_t step) {
    Sampler random = luck.of(taken + step);
    return Model::step(state, step < way.size() ? way[step] : values.action(), random).reward;
  };
  const auto [sum, discount] = earned_in<Model>(way.size() + values.settling(), state, take, {earned, std::pow(Model::discount, taken)});
  return sum + discount * values.value(state);
}

template <class Model>
double saved(const RestValues<Model>& values, const Rest<Model>& rest, const Option& way, const typename Model::State& state, const StepLuck& luck) {
  return returned_along(values, way, state, luck) - rest.returned(way.size() + values.settling());
}

// How many steps of the model take as long as a rest, or a way, whose states are valued: a value takes about as long as a step.
inline double steps_of_rest(std::size_t steps) { return 2.0 * (steps + 1); }
inline double steps_of_way(std::size_t steps) { return static_cast<double>(steps + 1); }

template <class Model>
class SavingSearch {
 public:
  using State = typename Model::State;
  static constexpr std::size_t longest = 10;  // actions of a way

  SavingSearch(const LeafCells<Model>& cells, const RestValues<Model>& values) : cells_(cells), values_(values) {}

  // The ways from a state that save most in each step. `steps` is counted down.
  List<Option> from(const State& start, double& steps, Sampler& random) {
    List<Option> ways;
    for (int width = 1; width <= 2 && steps > 0; ++width) {
      for (Option& way : confirmed(start, width, steps, random)) {
        if (std::ranges::find(ways, way) == ways.end()) ways.push_back(std::move(way));
      }
    }
    return ways;
  }

 private:
  static constexpr double max_steps = 10'000;  // of the model, at each width
  static constexpr std::size_t max_found = 16;
  static constexpr int tries = 4;  // of each way that was found

  struct Worth {
    double earned;  // with the way to it
    double after;
    double all() const { return earned + after; }
  };
  struct Found {
    std::uint32_t node;
    int action;
    double income;
  };

  void search(const State& start, int width, double& steps, const StepLuck& luck) {
    const Rest<Model> rest{values_, start, longest, luck};
    double limit = std::min(max_steps, steps);
    found_.clear();
    nodes_.assign(1, {start, 0, -1, 0, 0});
    seen_.clear();
    const std::size_t actions = Model::action_count();
    cells_before_.resize(cells_.size());
    cells_after_.resize(actions * cells_.size());
    after_.resize(actions, start);
    cells_.write(start, cells_before_.data());
    note_cells(seen_, cells_before_.data(), cells_.size(), width, [](std::size_t) { return true; });
    for (std::uint32_t number = 0; number < nodes_.size() && limit > 0 && nodes_[number].depth < longest; ++number) {
      const std::uint32_t depth = nodes_[number].depth;
      const double discount = std::pow(Model::discount, depth);
      cells_.write(nodes_[number].state, cells_before_.data());
      worths_.clear();
      for (std::size_t a = 0; a < actions; ++a) {
        after_[a] = nodes_[number].state;
        Sampler random = luck.of(depth);
        const double reward = Model::step(after_[a], a, random).reward;
        worths_.push_back({nodes_[number].earned + discount * reward, discount * Model::discount * values_.value(after_[a])});
        cells_.write(after_[a], &cells_after_[a * cells_.size()]);
      }
      limit -= actions;
      steps -= actions * steps_of_way(1);
      find_own_changes(actions);
      const double resting = worths_[values_.action()].all();
      for (std::size_t a = 0; a < actions; ++a) {
        const double saved = worths_[a].all() - rest.returned(depth + 1);
        if (saved > 0 && worths_[a].all() > resting) found_.push_back({number, static_cast<int>(a), income<Model>(saved, depth + 1)});
        if (Model::ending(after_[a]) == Ending::running && is_new(a, width)) nodes_.push_back({after_[a], number, static_cast<int>(a), worths_[a].earned, depth + 1});
      }
    }
    sort_stably(found_, [](const Found& one, const Found& other) { return one.income > other.income; });
    found_.resize(std::min(found_.size(), max_found));
  }

  // The ways that also save something under other luck.
  List<Option> confirmed(const State& start, int width, double& steps, Sampler& random) {
    search(start, width, steps, StepLuck{random});
    List<Option> ways;
    for (const Found& last : found_) {
      Option way = way_through(nodes_, last.node, last.action);
      double sum = 0;
      for (int i = 0; i < tries; ++i) {
        const StepLuck luck{random};
        sum += saved(values_, Rest<Model>{values_, start, way.size(), luck}, way, start, luck);
      }
      steps -= tries * (steps_of_way(way.size() + values_.settling()) + steps_of_rest(way.size() + values_.settling()));
      if (sum > 0) ways.push_back(std::move(way));
    }
    return ways;
  }

  void find_own_changes(std::size_t actions) {
    is_own_.assign(actions * cells_.size(), false);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto value = [&](std::size_t a) { return cells_after_[a * cells_.size() + i]; };
      const std::uint64_t by_itself = value_in_common(value, actions, cells_before_[i]);
      for (std::size_t a = 0; a < actions; ++a) is_own_[a * cells_.size() + i] = value(a) != by_itself;
    }
  }
  // Notes what an action changes. Returns whether anything of it is new.
  bool is_new(std::size_t action, int width) {
    const std::size_t first = action * cells_.size();
    return note_cells(seen_, &cells_after_[first], cells_.size(), width, [&](std::size_t i) { return is_own_[first + i] != 0; });
  }

  const LeafCells<Model>& cells_;
  const RestValues<Model>& values_;
  List<WayNode<State>> nodes_;
  List<Found> found_;
  SeenCells seen_;
  // Of the node at hand, by action:
  List<State> after_;
  List<Worth> worths_;
  List<std::uint64_t> cells_before_;
  List<std::uint64_t> cells_after_;  // [action * variables + variable]
  List<char> is_own_;                // [action * variables + variable]
};

}
