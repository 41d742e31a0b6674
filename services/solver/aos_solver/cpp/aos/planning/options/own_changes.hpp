// What actions change, apart from what the world changes by itself in the same step: doors that open, batteries that drain.
//
// All actions are taken from a state with the same random numbers. What most of them do alike is the world's doing: a model
// need not say what changes by itself. What actions of few skills do alike is theirs, however many actions they have. An action
// changes a variable where its result is another one. What drifts in the code of each skill draws other numbers there: that all
// actions change it alike is told by how often and how far, over the states.
#pragma once

#include "aos/base/statistics.hpp"
#include "aos/base/switches.hpp"
#include "aos/planning/values/leaf_cells.hpp"

namespace aos {

inline constexpr double most_actions = 0.75;  // do alike what the world does

// The value that most of so many actions lead to, by `value_of` an action; without one the value before.
std::uint64_t value_in_common(auto&& value_of, std::size_t actions, std::uint64_t before) {
  // A value of more than half of the actions outlasts all others (majority vote: Boyer and Moore, 1991).
  std::uint64_t candidate = before;
  std::size_t votes = 0;
  for (std::size_t a = 0; a < actions; ++a) {
    if (votes == 0) candidate = value_of(a);
    votes = value_of(a) == candidate ? votes + 1 : votes - 1;
  }
  std::size_t alike = 0;
  for (std::size_t a = 0; a < actions; ++a) alike += value_of(a) == candidate ? 1 : 0;
  return static_cast<double>(alike) >= most_actions * static_cast<double>(actions) ? candidate : before;
}

template <class Model>
class OwnChanges {
 public:
  using State = typename Model::State;

  // Takes each action once from each state. `steps` is counted down.
  void measure(const List<State>& states, const LeafCells<Model>& cells, double& steps, Sampler& random) {
    const std::size_t actions = Model::action_count();
    moves_.assign(actions, false);
    is_changed_.assign(cells.size(), false);
    is_worlds_.assign(cells.size(), false);
    start_.resize(cells.size());
    after_.resize(actions * cells.size());
    ends_.resize(actions);
    is_own_.assign(actions * cells.size(), false);
    List<std::size_t> earning(actions);
    List<double> rewards(actions);
    for (const State& state : states) {
      cells.write(state, start_.data());
      const Sampler luck{random.bits()};
      for (std::size_t a = 0; a < actions; ++a) {
        State next = state;
        Sampler same = luck;
        const double reward = Model::step(next, a, same).reward;
        earning[a] += reward > 0 ? 1 : 0;
        rewards[a] += reward / static_cast<double>(states.size());
        if (are_alike<Model>(state, next)) std::ranges::copy(start_, after_.begin() + a * cells.size());
        else cells.write(next, &after_[a * cells.size()]);
        ends_[a] = Model::ending(next) != Ending::running ? 1 : 0;
      }
      compare(cells.size());
    }
    steps -= actions * states.size();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool is_drift = switches::drifting && may_drift(i) && drifts(i, states, cells, steps, random);
      is_worlds_[i] = is_worlds_[i] || is_drift;
      for (std::size_t a = 0; a < actions; ++a) {
        if (is_own_[a * cells.size() + i] && !is_drift) moves_[a] = is_changed_[i] = true;
      }
    }
    const auto is_most = [](std::size_t count, std::size_t all) { return static_cast<double>(count) >= most_actions * static_cast<double>(all); };
    earns_anyway_ = is_most(std::accumulate(earning.begin(), earning.end(), std::size_t{0}), actions * states.size());
    earns_idle_ = false;
    double idle = -std::numeric_limits<double>::infinity();
    idle_action_ = -1;
    for (std::size_t a = 0; a < actions; ++a) {
      earns_idle_ |= !moves_[a] && is_most(earning[a], states.size());
      if (moves_[a] || rewards[a] <= idle) continue;
      idle = rewards[a];
      idle_action_ = static_cast<int>(a);
    }
    idle_cost_ = std::isfinite(idle) ? std::max(-idle, 0.0) : 0;
  }

  // Whether the action changes any of the states, or ends the mission.
  bool is_move(int action) const { return moves_[action]; }
  // Whether an action is no move.
  bool leaves_tests() const { return std::ranges::count(moves_, false) > 0; }
  // Whether the next step earns something whatever the robot does.
  bool earns_anyway() const { return earns_anyway_; }
  // Whether an action that changes nothing earns something in the next step.
  bool earns_idle() const { return earns_idle_; }
  // What a step costs at least that changes nothing.
  double idle_cost() const { return idle_cost_; }
  // The action of such a step; -1 without one.
  int idle_action() const { return idle_action_; }
  // Whether a variable changes by itself, and no action changes it. Of one that was found after `measure` this is not known.
  bool is_worlds(std::size_t variable) const { return variable < is_worlds_.size() && is_worlds_[variable] && !is_changed_[variable]; }

 private:
  // Of what may drift:
  static constexpr std::size_t tries = 4;      // of each action from each state
  static constexpr double fewest = 64;         // tries that tell how often and how far
  static constexpr double least_drift = 0.2;   // of the tries, after each action
  static constexpr double far = 8;             // cells: what is farther counts as that
  static constexpr double most_errors = 4;     // between actions that do alike
  static constexpr double least_spread = 0.1;  // of a change, so that two seldom ones may differ

  void compare(std::size_t variables) {
    const std::size_t actions = moves_.size();
    const std::uint64_t by_most = value_in_common([&](std::size_t a) { return ends_[a]; }, actions, 0);
    const std::uint64_t ending = leaves_all(variables) ? 0 : by_most;
    // What an action does that ends the mission says nothing of the world.
    std::vector<std::size_t> alike;
    for (std::size_t a = 0; a < actions; ++a) {
      if (ends_[a] == ending) alike.push_back(a);
      else moves_[a] = true;
    }
    for (std::size_t i = 0; i < variables; ++i) {
      const auto value = [&](std::size_t a) { return after_[a * variables + i]; };
      const std::uint64_t by_itself = value_of_most_skills(alike, value, start_[i]);
      if (by_itself != start_[i]) is_worlds_[i] = true;
      for (std::size_t a = 0; a < actions; ++a) {
        is_own_[a * variables + i] = is_own_[a * variables + i] || value(a) != by_itself;
      }
    }
  }

  // Whether some action changes a variable in its own way, and all of them or the world do change it.
  bool may_drift(std::size_t variable) const {
    std::size_t own = 0;
    for (std::size_t a = 0; a < moves_.size(); ++a) own += is_own_[a * is_changed_.size() + variable] ? 1 : 0;
    return own > 0 && (is_worlds_[variable] || own == moves_.size());
  }

  // Whether chance changes a variable after each action, and after all of them as often and as far.
  bool drifts(std::size_t variable, const List<State>& states, const LeafCells<Model>& cells, double& steps, Sampler random) {
    List<SampleMean> changes(moves_.size()), distances(moves_.size());  // by action
    for (std::size_t a = 0; a < moves_.size(); ++a) {
      for (std::size_t i = 0; i < tries * states.size(); ++i) {
        State next = states[i % states.size()];
        cells.write(next, start_.data());
        Model::step(next, a, random);
        if (Model::ending(next) != Ending::running) continue;
        cells.write(next, after_.data());
        const auto distance = static_cast<double>(static_cast<std::int64_t>(after_[variable] - start_[variable]));
        changes[a].add(distance != 0 ? 1 : 0);
        distances[a].add(std::clamp(distance, -far, far));
      }
      steps -= tries * states.size();
      if (changes[a].count() < fewest || changes[a].mean() < least_drift) return false;
    }
    return differ_by_chance(changes) && differ_by_chance(distances);
  }

  static bool differ_by_chance(const List<SampleMean>& means) {
    SampleMean all, spread;
    for (const SampleMean& mean : means) {
      all.add(mean.mean());
      spread.add(mean.deviation());
    }
    const double error = most_errors * std::max(spread.mean(), least_spread);
    return std::ranges::all_of(means, [&](const SampleMean& mean) { return std::abs(mean.mean() - all.mean()) <= error / std::sqrt(mean.count()); });
  }

  // The value that most of the actions lead to, or else most of the others, if it is one of most skills; without one the value before.
  std::uint64_t value_of_most_skills(std::vector<std::size_t> actions, auto&& value, std::uint64_t before) const {
    const std::vector<std::size_t> all = actions;
    while (!actions.empty()) {
      const std::uint64_t common = value_in_common([&](std::size_t n) { return value(actions[n]); }, actions.size(), before);
      const auto leads_there = [&](std::size_t a) { return value(a) == common; };
      if (common == before || is_of_most_skills(all, leads_there)) return common;
      std::erase_if(actions, leads_there);
    }
    return before;
  }

  // Whether half of the skills of these actions, or more, have one that does so.
  bool is_of_most_skills(const std::vector<std::size_t>& actions, auto&& does) const {
    std::vector<bool> all(Model::skill_count), doing(Model::skill_count);
    for (const std::size_t a : actions) {
      all[Model::skill_of(a)] = true;
      if (does(a)) doing[Model::skill_of(a)] = true;
    }
    return 2 * std::ranges::count(doing, true) >= std::ranges::count(all, true);
  }

  // Whether an action leaves the state as it was, so that the world does not end the mission.
  bool leaves_all(std::size_t variables) const {
    for (std::size_t a = 0; a < moves_.size(); ++a) {
      if (ends_[a] == 0 && std::equal(start_.begin(), start_.end(), after_.begin() + a * variables)) return true;
    }
    return false;
  }

  bool earns_anyway_ = false;
  bool earns_idle_ = false;
  double idle_cost_ = 0;
  int idle_action_ = -1;
  std::vector<bool> moves_;       // by action
  std::vector<bool> is_changed_;  // by variable
  std::vector<bool> is_worlds_;   // by variable
  // Of the state at hand:
  List<std::uint64_t> start_;
  List<std::uint64_t> after_;  // [action * variables + variable]
  List<std::uint64_t> ends_;   // by action
  std::vector<bool> is_own_;   // [action * variables + variable]: a change that not most actions make
};

}
