// The places that moves lead to which tell nothing, the tests that can be made there, the ends, and the ways between.
#pragma once

#include "aos/planning/budget.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"
#include "aos/planning/values/running_down.hpp"

namespace aos {

template <class Model>
class SeekPlaces {
 public:
  using State = typename Model::State;
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

  struct Move {
    std::uint32_t next = nowhere;  // nowhere for what is no move
    double paid = 0;               // on average
  };
  struct Place {
    List<State> states;
    List<Move> moves{};  // by action
  };
  struct Test {
    std::uint32_t place;
    int action;
    double reward;                    // on average, where it does not win
    std::size_t outcomes;
    List<double> odds{};       // [state * outcomes + outcome], later by class
    List<double> doubts{};     // by class: the entropy of what is observed
    List<double> own{};        // as `odds`, by state
  };
  struct End {
    std::uint32_t place;
    int action;
    double reward;
  };
  struct Arrival {  // at a place, on the way from another one
    std::uint32_t distance = nowhere;
    std::uint32_t before = nowhere;
    int by = -1;
    double paid = 0;
  };
  using Ways = List<Arrival>;  // by place

  // Finds places from the states of a belief on, breadth first, all states in step and under the same luck. Takes about half of the steps
  // at most. Returns whether these were enough for all actions where the robot is.
  bool explore(const SampledBelief<Model>& belief, RunningDown<Model>& running_down, const BarredActions& barred, double& steps, Sampler& random) {
    places_.clear();
    tests_.clear();
    ends_.clear();
    ways_.clear();
    after_.clear();
    known_.clear();
    reports_.resize(belief.size());
    const std::size_t actions = Model::action_count();
    places_.push_back({belief.states()});
    known_.emplace(running_down.place_of(places_[0].states), 0);
    const double least = steps / 2;
    for (std::uint32_t number = 0; number < places_.size() && steps > least; ++number) {
      places_[number].moves.resize(actions);
      for (std::size_t a = 0; a < actions; ++a) {
        if (number == 0 && steps <= least) return false;
        if (!barred.contains(a)) take(number, a, belief, running_down, steps, random);
      }
    }
    for (Place& place : places_) place.moves.resize(actions);
    return true;
  }

  const List<Place>& places() const { return places_; }
  List<Test>& tests() { return tests_; }
  List<End>& ends() { return ends_; }
  // The states of the belief after a test, until the next exploration.
  const List<State>& after(std::size_t test) const { return after_[test]; }

  const Ways& ways_from(std::uint32_t start) {
    const auto [entry, is_new] = ways_.try_emplace(start);
    Ways& ways = entry->second;
    if (!is_new) return ways;
    ways.resize(places_.size());
    ways[start].distance = 0;
    List<std::uint32_t> open{start};
    for (std::size_t i = 0; i < open.size(); ++i) {
      const List<Move>& moves = places_[open[i]].moves;
      for (std::size_t a = 0; a < moves.size(); ++a) {
        const std::uint32_t to = moves[a].next;
        if (to == nowhere || ways[to].distance != nowhere) continue;
        const Arrival& here = ways[open[i]];
        ways[to] = {here.distance + 1, open[i], static_cast<int>(a), here.paid + std::pow(Model::discount, here.distance) * moves[a].paid};
        open.push_back(to);
      }
    }
    return ways;
  }
  List<int> way(std::uint32_t from, std::uint32_t to, int last) {
    const Ways& ways = ways_from(from);
    List<int> actions{last};
    for (; to != from; to = ways[to].before) actions.push_back(ways[to].by);
    std::ranges::reverse(actions);
    return actions;
  }

 private:
  static constexpr std::size_t most_places = 256;
  static constexpr int cells_of_numbers = 6;
  static constexpr int quantiles = 16;

  // Takes an action at a place from all states. It is an end, a test, or a move to a place.
  void take(std::uint32_t number, int action, const SampledBelief<Model>& belief, RunningDown<Model>& running_down, double& steps, Sampler& random) {
    List<State> next = places_[number].states;
    const Sampler luck{random.bits()};
    double reward = 0, running = 0, failing = 0;
    bool tells = false;
    for (std::size_t k = 0; k < next.size(); ++k) {
      Sampler same = luck;
      reward += belief.weights()[k] * reported_.take(next[k], action, reports_[k], steps, same);
      running += Model::ending(next[k]) == Ending::running ? belief.weights()[k] : 0;
      failing += Model::ending(next[k]) == Ending::failure ? belief.weights()[k] : 0;
      tells = tells || !reports_[k].is_like(reports_[0]);
    }
    Move& move = places_[number].moves[action];
    move.paid = reward;
    if (running < 0.5) {
      if (failing < 0.5) ends_.push_back({number, action, reward});
      return;
    }
    if (tells) return add_test(number, action, reward, next);
    const auto place = static_cast<std::uint32_t>(places_.size());
    const std::uint64_t key = running_down.place_of(next);
    if (place >= most_places && !known_.contains(key)) return;
    move.next = known_.emplace(key, place).first->second;
    if (move.next == place) places_.push_back({std::move(next)});
  }

  void add_test(std::uint32_t place, int action, double reward, List<State>& next) {
    Test test{place, action, reward, 0};
    const List<Observation> responses = few_responses(reports_);
    if (!responses.empty()) {
      test.outcomes = responses.size();
      for (const StepReports& report : reports_) {
        for (const Observation response : responses) test.own.push_back(report.likelihood({response, {}}));
      }
    } else if (!by_cells(test)) {
      return;
    }
    tests_.push_back(std::move(test));
    after_.resize(tests_.size());
    after_.back() = std::move(next);
  }

  // A number that is reported falls into one of a few cells of about the same probability.
  bool by_cells(Test& test) const {
    List<double> all;
    List<List<double>> own(reports_.size());
    for (std::size_t k = 0; k < reports_.size(); ++k) {
      const auto& branches = reports_[k].branches();
      if (branches.size() != 1 || branches[0].numbers.size() != 1) return false;
      for (int i = 0; i < quantiles; ++i) own[k].push_back(branches[0].numbers[0].second.quantile((i + 0.5) / quantiles));
      all.insert(all.end(), own[k].begin(), own[k].end());
    }
    std::ranges::sort(all);
    test.outcomes = cells_of_numbers;
    for (const auto& numbers : own) {
      List<double> odds(cells_of_numbers, 0.01 / cells_of_numbers);
      for (const double number : numbers) {
        const std::size_t rank = std::ranges::lower_bound(all, number) - all.begin();
        odds[std::min<std::size_t>(rank * cells_of_numbers / all.size(), cells_of_numbers - 1)] += 0.99 / quantiles;
      }
      test.own.insert(test.own.end(), odds.begin(), odds.end());
    }
    return true;
  }

  ReportedStep<Model> reported_;
  List<StepReports> reports_;  // of the action at hand, by state
  std::unordered_map<std::uint64_t, std::uint32_t> known_;  // places
  List<Place> places_;
  List<Test> tests_;
  List<List<State>> after_;  // by test
  List<End> ends_;
  std::map<std::uint32_t, Ways> ways_;  // by the place where they begin
};

}
