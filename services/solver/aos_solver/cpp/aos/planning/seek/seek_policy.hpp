// Looks for one thing among many places: goes where a nat is cheapest, looks there, and ends in time.
//
// A few states of the belief stand for it. From them the places are found that moves lead to which tell nothing (breadth first, all states
// in step, under the same luck). What only runs down, such as a battery, makes no place new. In each place each action is a test: what it tells of
// the class of the state, and whether it wins, which is to say that the best end after it returns more than without it. States that win by the same tests are a class.
// The policy takes the test, with the way to it, that tells most for what it costs, as long as the best end can be had after it.
// Missions by this policy, whose true state the code of the model steps, tell what it returns.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/mixed.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/step.hpp"
#include "aos/model/values.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

// What a policy returns, with its standard error, and the action that it takes first.
struct Sought {
  int action = -1;  // none
  double returned = 0;
  double error = 0;
};

template <class Model>
class SeekPolicy {
 public:
  using State = typename Model::State;

  // Finds the policy for a belief and plays missions by it, in about so many steps of the model. None where no test wins.
  Sought find(const Belief<Model>& belief, int horizon, const BarredActions& barred, double affordable, Sampler& random) {
    horizon_ = horizon;
    steps_ = affordable;
    belief_.draw(belief, most_states, random);
    if (!is_prepared_) {
      find_cells(belief, random);
      find_lasting(belief, random);
    }
    is_prepared_ = true;
    explore(barred, random);
    find_ends();
    find_wins(random);
    if (tests_.empty() || classes_ == 0) return {};
    find_classes();
    const int first = first_action(random);
    if (first < 0) return {};
    double sum = 0, squares = 0, count = 0;
    steps_ = std::max(steps_, affordable / 2);
    for (int mission = 0; mission < most_missions && (mission < fewest_missions || steps_ > 0); ++mission) {
      const auto k = static_cast<std::size_t>(random.choose(belief_.weights().data(), static_cast<int>(belief_.size()), 1.0));
      const double one = played(k, random);
      sum += one;
      squares += one * one;
      ++count;
    }
    const double mean = sum / count;
    return {first, mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / (count - 1))};
  }
  // What is returned if the mission is brought to its best end at once.
  double given_up() const { return given_up_; }
  void start_over() { is_prepared_ = false; }

 private:
  static constexpr std::size_t most_states = 64;
  static constexpr std::size_t most_places = 256;
  static constexpr std::size_t most_ends = 3;
  static constexpr int fewest_missions = 16;
  static constexpr int most_missions = 64;
  static constexpr int cells_of_numbers = 6;
  static constexpr int quantiles = 16;
  static constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

  struct Place {
    std::vector<State> states;
    std::vector<std::uint32_t> next;  // by action; nowhere for what is no move
    std::vector<double> paid;         // by action, on average
  };
  struct Test {
    std::uint32_t place;
    int action;
    double reward;                    // on average, where it does not win
    std::size_t outcomes;
    std::vector<double> odds{};       // [state * outcomes + outcome], later by class
    std::vector<double> doubts{};     // by class: the entropy of what is observed
    std::vector<double> own{};        // as `odds`, by state
  };
  struct End {
    std::uint32_t place;
    int action;
    double reward;
  };
  struct Ways {  // from a place
    std::vector<std::uint32_t> distance;
    std::vector<std::uint32_t> before;
    std::vector<int> by;
    std::vector<double> paid;
  };

  // --- places -----------------------------------------------------------------------------------------

  // Finds the variables that tell places apart: those that do not only run one way.
  void find_cells(const Belief<Model>& belief, Sampler& random) {
    cells_.prepare(belief, random);
    std::vector<int> ups(cells_.size()), downs(cells_.size());
    std::vector<std::uint64_t> before(cells_.size()), after(cells_.size());
    int taken = 0;
    RandomWalk<Model> walk;
    for (int i = 0; i < 50; ++i) {
      State state = belief.sample(random);
      walk.start();
      for (int step = 0; step < 20 && Model::ending(state) == Ending::running; ++step, ++taken) {
        cells_.write(state, before.data());
        Model::step(state, walk.next(state, random), random);
        cells_.write(state, after.data());
        for (std::size_t c = 0; c < cells_.size(); ++c) {
          const auto change = static_cast<std::int64_t>(after[c] - before[c]);
          ups[c] += change > 0;
          downs[c] += change < 0;
        }
      }
    }
    runs_.assign(cells_.size(), false);
    for (std::size_t c = 0; c < cells_.size(); ++c) runs_[c] = std::min(ups[c], downs[c]) == 0 && 2 * std::max(ups[c], downs[c]) > taken;
    cell_.resize(cells_.size());
  }
  // Finds which bytes of a state belong to numbers that change in most steps, and only one way.
  void find_lasting(const Belief<Model>& belief, Sampler& random) {
    std::vector<std::pair<std::size_t, Leaf>> leaves;
    const State& any = belief.particles().front().state;
    NamedLeaves named{[&](const std::string&, const Leaf& leaf) {
      const auto offset = static_cast<const std::byte*>(leaf.place) - Model::bytes_of(any);
      if (offset >= 0 && offset < static_cast<std::ptrdiff_t>(Model::state_bytes()) && !is_text(leaf)) leaves.emplace_back(offset, leaf);
    }};
    Model::visit_values(any, named);
    const auto number = [](const std::pair<std::size_t, Leaf>& leaf, const State& state) {
      const std::byte* const place = Model::bytes_of(state) + leaf.first;
      if (leaf.second.kind == Leaf::Kind::real) return leaf.second.size == sizeof(float) ? static_cast<double>(stored_at<float>(place)) : stored_at<double>(place);
      return leaf.second.size == sizeof(std::int32_t) ? static_cast<double>(stored_at<std::int32_t>(place)) : static_cast<double>(std::to_integer<int>(*place));
    };
    std::vector<int> ups(leaves.size()), downs(leaves.size());
    int taken = 0;
    RandomWalk<Model> walk;
    for (int i = 0; i < 50; ++i) {
      State state = belief.sample(random);
      walk.start();
      for (int step = 0; step < 20 && Model::ending(state) == Ending::running; ++step, ++taken) {
        const State before = state;
        Model::step(state, walk.next(state, random), random);
        for (std::size_t l = 0; l < leaves.size(); ++l) {
          ups[l] += number(leaves[l], state) > number(leaves[l], before);
          downs[l] += number(leaves[l], state) < number(leaves[l], before);
        }
      }
    }
    lasts_.assign(Model::state_bytes(), true);
    for (std::size_t l = 0; l < leaves.size(); ++l) {
      if (std::min(ups[l], downs[l]) > 0 || 2 * std::max(ups[l], downs[l]) <= taken) continue;
      for (std::size_t i = 0; i < leaves[l].second.size; ++i) lasts_[leaves[l].first + i] = false;
    }
  }
  // Whether two states differ, but for what only runs one way.
  bool differ(const State& one, const State& other) const {
    const std::byte* const left = Model::bytes_of(one);
    const std::byte* const right = Model::bytes_of(other);
    for (std::size_t i = 0; i < lasts_.size(); ++i) {
      if (lasts_[i] && left[i] != right[i]) return true;
    }
    return false;
  }
  std::uint64_t place_of(const State& state) {
    cells_.write(state, cell_.data());
    std::uint64_t key = Model::ending(state) == Ending::running ? 1 : 0;
    for (std::size_t c = 0; c < cell_.size(); ++c) key = runs_[c] ? key : mixed(key, cell_[c]);
    return key;
  }
  std::uint64_t place_of(const std::vector<State>& states) {
    std::uint64_t key = 0;
    for (const State& state : states) key = mixed(key, place_of(state));
    return key;
  }

  void explore(const BarredActions& barred, Sampler& random) {
    places_.clear();
    tests_.clear();
    ends_.clear();
    ways_.clear();
    wins_.assign(belief_.size(), 0);
    classes_ = 0;
    std::unordered_map<std::uint64_t, std::uint32_t> known;
    const auto actions = static_cast<std::size_t>(Model::action_count());
    places_.push_back({belief_.states(), {}, {}});
    known.emplace(place_of(places_[0].states), 0);
    std::vector<StepReports> reports(belief_.size());
    const double least = steps_ / 2;
    for (std::uint32_t number = 0; number < places_.size() && steps_ > least; ++number) {
      places_[number].next.assign(actions, nowhere);
      places_[number].paid.assign(actions, 0);
      for (std::size_t a = 0; a < actions; ++a) {
        if (barred.contains(a)) continue;
        std::vector<State> next = places_[number].states;
        const Sampler luck{random.bits()};
        double reward = 0, running = 0, failing = 0;
        bool tells = false;
        for (std::size_t k = 0; k < next.size(); ++k) {
          Sampler same = luck;
          reward += belief_.weights()[k] * reported_.take(next[k], static_cast<int>(a), reports[k], steps_, same);
          running += Model::ending(next[k]) == Ending::running ? belief_.weights()[k] : 0;
          failing += Model::ending(next[k]) == Ending::failure ? belief_.weights()[k] : 0;
          tells = tells || !reports[k].is_like(reports[0]);
        }
        places_[number].paid[a] = reward;
        if (running < 0.5) {
          if (failing < 0.5) ends_.push_back({number, static_cast<int>(a), reward});
          continue;
        }
        if (tells) {
          add_test(number, static_cast<int>(a), reward, reports, next);
          continue;
        }
        const auto [entry, is_new] = known.emplace(place_of(next), static_cast<std::uint32_t>(places_.size()));
        if (is_new && places_.size() >= most_places) {
          known.erase(entry);
          continue;
        }
        places_[number].next[a] = entry->second;
        if (is_new) places_.push_back({std::move(next), {}, {}});
      }
    }
    for (Place& place : places_) {
      place.next.resize(actions, nowhere);
      place.paid.resize(actions, 0);
    }
  }

  void add_test(std::uint32_t place, int action, double reward, const std::vector<StepReports>& reports, std::vector<State>& next) {
    Test test{place, action, reward, 0};
    const std::vector<Observation> responses = few_responses(reports);
    if (!responses.empty()) {
      test.outcomes = responses.size();
      for (const StepReports& report : reports) {
        for (const Observation response : responses) test.own.push_back(report.likelihood({response, {}}));
      }
    } else if (!by_cells(reports, test)) {
      return;
    }
    tests_.push_back(std::move(test));
    after_.resize(tests_.size());
    after_.back() = std::move(next);
  }

  // A number that is reported falls into one of a few cells of about the same probability.
  bool by_cells(const std::vector<StepReports>& reports, Test& test) {
    std::vector<double> all;
    std::vector<std::vector<double>> own(reports.size());
    for (std::size_t k = 0; k < reports.size(); ++k) {
      const auto& branches = reports[k].branches();
      if (branches.size() != 1 || branches[0].numbers.size() != 1) return false;
      for (int i = 0; i < quantiles; ++i) own[k].push_back(branches[0].numbers[0].second.quantile((i + 0.5) / quantiles));
      all.insert(all.end(), own[k].begin(), own[k].end());
    }
    std::ranges::sort(all);
    test.outcomes = cells_of_numbers;
    for (const auto& numbers : own) {
      std::vector<double> odds(cells_of_numbers, 0.01 / cells_of_numbers);
      for (const double number : numbers) {
        const auto rank = static_cast<std::size_t>(std::ranges::lower_bound(all, number) - all.begin());
        odds[std::min<std::size_t>(rank * cells_of_numbers / all.size(), cells_of_numbers - 1)] += 0.99 / quantiles;
      }
      test.own.insert(test.own.end(), odds.begin(), odds.end());
    }
    return true;
  }

  const Ways& ways_from(std::uint32_t start) {
    const auto [entry, is_new] = ways_.try_emplace(start);
    Ways& ways = entry->second;
    if (!is_new) return ways;
    ways.distance.assign(places_.size(), nowhere);
    ways.before.assign(places_.size(), nowhere);
    ways.by.assign(places_.size(), -1);
    ways.paid.assign(places_.size(), 0);
    ways.distance[start] = 0;
    std::vector<std::uint32_t> open{start};
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Place& place = places_[open[i]];
      for (std::size_t a = 0; a < place.next.size(); ++a) {
        const std::uint32_t to = place.next[a];
        if (to == nowhere || ways.distance[to] != nowhere) continue;
        ways.distance[to] = ways.distance[open[i]] + 1;
        ways.before[to] = open[i];
        ways.by[to] = static_cast<int>(a);
        ways.paid[to] = ways.paid[open[i]] + std::pow(Model::discount, ways.distance[open[i]]) * place.paid[a];
        open.push_back(to);
      }
    }
    return ways;
  }
  std::vector<int> way(std::uint32_t from, std::uint32_t to, int last) {
    const Ways& ways = ways_from(from);
    std::vector<int> actions{last};
    for (; to != from; to = ways.before[to]) actions.push_back(ways.by[to]);
    std::ranges::reverse(actions);
    return actions;
  }

  // --- ends and wins ----------------------------------------------------------------------------------

  // Keeps the ends that return most on average.
  void find_ends() {
    std::ranges::stable_sort(ends_, [](const End& one, const End& other) { return one.reward > other.reward; });
    if (ends_.size() > most_ends) ends_.resize(most_ends);
    given_up_ = ended(0, belief_.states().front(), Sampler{1}).returned;
  }

  struct Ended {
    int action = -1;  // the first one
    double returned = 0;
    bool fails = false;
  };
  // What the best end returns from a state at a place; 0 without an end.
  Ended ended(std::uint32_t place, const State& start, Sampler random) {
    Ended best;
    for (const End& end : ends_) {
      if (ways_from(place).distance[end.place] == nowhere) continue;
      State state = start;
      const std::vector<int> actions = way(place, end.place, end.action);
      const double returned = taken(state, actions, random);
      if (best.action >= 0 && returned <= best.returned) continue;
      best = {actions.front(), returned, Model::ending(state) == Ending::failure};
    }
    return best;
  }
  double taken(State& state, const std::vector<int>& actions, Sampler& random) {
    double sum = 0, discount = 1;
    for (const int action : actions) {
      if (Model::ending(state) != Ending::running) break;
      sum += discount * Model::step(state, action, random).reward;
      discount *= Model::discount;
      --steps_;
    }
    return sum;
  }

  // Notes for each state by which tests it wins.
  void find_wins(Sampler& random) {
    stake_ = 0;
    double wins = 0;
    for (std::size_t t = 0; t < tests_.size(); ++t) {
      Test& test = tests_[t];
      const std::vector<State>& before = places_[test.place].states;
      for (std::size_t k = 0; k < before.size(); ++k) {
        if (!differ(after_[t][k], before[k])) continue;
        const bool goes_on = Model::ending(after_[t][k]) == Ending::running;
        State last = before[k];
        Sampler luck{random.bits()};
        const double reward = goes_on ? test.reward : Model::step(last, test.action, luck).reward;
        const double now = ended(test.place, before[k], random).returned;
        const double then = reward + (goes_on ? Model::discount * ended(test.place, after_[t][k], random).returned : 0);
        if (then <= std::max(now, 0.0)) continue;
        wins_[k] = mixed(wins_[k], t + 1);
        ++classes_;
        stake_ += then - now;
        ++wins;
      }
    }
    if (wins > 0) stake_ /= wins;
    after_.clear();
  }

  void find_classes() {
    std::map<std::uint64_t, std::size_t> numbers;
    class_of_.clear();
    for (const std::uint64_t key : wins_) class_of_.push_back(numbers.emplace(key, numbers.size()).first->second);
    classes_ = numbers.size();
    prior_.assign(classes_, 0);
    for (std::size_t k = 0; k < belief_.size(); ++k) prior_[class_of_[k]] += belief_.weights()[k];
    for (Test& test : tests_) {
      test.odds.assign(classes_ * test.outcomes, 0);
      for (std::size_t k = 0; k < belief_.size(); ++k) {
        const double share = belief_.weights()[k] / prior_[class_of_[k]];
        for (std::size_t o = 0; o < test.outcomes; ++o) test.odds[class_of_[k] * test.outcomes + o] += share * test.own[k * test.outcomes + o];
      }
      for (std::size_t z = 0; z < classes_; ++z) {
        double doubt = 0;
        for (std::size_t o = 0; o < test.outcomes; ++o) doubt += entropy(test.odds[z * test.outcomes + o]);
        test.doubts.push_back(doubt);
      }
    }
  }
  static double entropy(double p) { return p > 0 ? -p * std::log(p) : 0; }

  // --- the policy -------------------------------------------------------------------------------------

  double information(const Test& test, const std::vector<double>& weights) {
    seen_.assign(test.outcomes, 0);
    double doubt = 0;
    for (std::size_t z = 0; z < classes_; ++z) {
      doubt += weights[z] * test.doubts[z];
      for (std::size_t o = 0; o < test.outcomes; ++o) seen_[o] += weights[z] * test.odds[z * test.outcomes + o];
    }
    double sum = -doubt;
    for (const double p : seen_) sum += entropy(p);
    return sum;
  }

  // The test whose nat is cheapest among those after which the best end does not fail; null if there is none.
  const Test* best_test(std::uint32_t place, const std::vector<double>& weights, const State& state, Sampler& random) {
    const Ways& ways = ways_from(place);
    ranked_.clear();
    for (const Test& test : tests_) {
      const std::uint32_t distance = ways.distance[test.place];
      if (distance == nowhere) continue;
      const double told = information(test, weights);
      if (told < least_information) continue;
      const double later = std::pow(Model::discount, distance);
      const double cost = (1 - later * Model::discount) * stake_ - ways.paid[test.place] - later * test.reward;
      ranked_.emplace_back(told / std::max(cost, 1e-9), &test);
    }
    steps_ -= static_cast<double>(tests_.size() * classes_) / 20;
    const std::size_t tried = std::min<std::size_t>(ranked_.size(), 4);
    std::partial_sort(ranked_.begin(), ranked_.begin() + static_cast<std::ptrdiff_t>(tried), ranked_.end(),
                      [](const auto& one, const auto& other) { return one.first > other.first; });
    for (std::size_t i = 0; i < tried; ++i) {
      const Test& test = *ranked_[i].second;
      State then = state;
      taken(then, way(place, test.place, test.action), random);
      if (ends_.empty() ? Model::ending(then) != Ending::failure
                        : Model::ending(then) == Ending::running ? !ended(test.place, then, random).fails : Model::ending(then) != Ending::failure) return &test;
    }
    return nullptr;
  }

  // The first action of the policy.
  int first_action(Sampler& random) {
    const State& any = belief_.states()[belief_.size() / 2];
    const Test* const test = best_test(0, prior_, any, random);
    if (test == nullptr) return ended(0, any, random).action;
    return way(0, test->place, test->action).front();
  }

  double played(std::size_t k, Sampler& random) {
    State state = belief_.states()[k];
    std::vector<double> weights = prior_;
    std::uint32_t place = 0;
    double sum = 0, discount = 1;
    for (int left = horizon_; left > 0;) {
      const Test* const test = best_test(place, weights, state, random);
      if (test == nullptr) return sum + discount * ended(place, state, random).returned;
      const std::vector<int> actions = way(place, test->place, test->action);
      State before = state;
      for (const int action : actions) {
        before = state;
        sum += discount * Model::step(state, action, random).reward;
        discount *= Model::discount;
        --steps_;
        --left;
        if (Model::ending(state) != Ending::running) return sum;
      }
      place = test->place;
      if (differ(state, before)) return sum + discount * ended(place, state, random).returned;
      const double* const own = &test->own[k * test->outcomes];
      const auto seen = static_cast<std::size_t>(random.choose(own, static_cast<int>(test->outcomes), 1.0));
      double all = 0;
      for (std::size_t z = 0; z < classes_; ++z) all += weights[z] *= test->odds[z * test->outcomes + seen];
      if (!(all > 0)) return sum + discount * ended(place, state, random).returned;
      for (double& weight : weights) weight /= all;
    }
    return sum;
  }

  static constexpr double least_information = 1e-4;

  bool is_prepared_ = false;
  int horizon_ = 1;
  double steps_ = 0;
  SampledBelief<Model> belief_;
  LeafCells<Model> cells_;
  std::vector<bool> runs_;  // by variable: whether it only runs one way
  std::vector<std::uint64_t> cell_;
  std::vector<bool> lasts_;  // by byte of a state
  ReportedStep<Model> reported_;
  std::vector<Place> places_;
  std::vector<Test> tests_;
  std::vector<std::vector<State>> after_;  // by test
  std::vector<End> ends_;
  std::map<std::uint32_t, Ways> ways_;
  std::vector<std::uint64_t> wins_;  // by state
  std::vector<std::size_t> class_of_;
  std::size_t classes_ = 0;
  std::vector<double> prior_;  // by class
  double stake_ = 0;
  double given_up_ = 0;
  std::vector<double> seen_;
  std::vector<std::pair<double, const Test*>> ranked_;
};

}  // namespace aos
