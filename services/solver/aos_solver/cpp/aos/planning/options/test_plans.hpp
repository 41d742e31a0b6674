// Plans that test until a choice among options is worth no further test. Things that are sorted, packed or repaired one by one have such a plan each.
//
// Options that change the same are a choice. A plan counts as an option does: it earns something from each state, and others follow it. So what can be found out
// later counts with all that the robot may do now.
#pragma once

#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/option_tests.hpp"

namespace aos {

template <class Model>
class TestPlans {
 public:
  TestPlans(const SampledBelief<Model>& belief, OptionGains<Model>& gains, const OptionTests<Model>& tests) : belief_(belief), gains_(gains), tests_(tests) {}

  // Adds a plan for each choice here that is worth a test, and one for all choices of a place elsewhere. Each is made twice, since what follows by the plans of
  // others has to wait for its tests.
  void add(const BarredActions& barred, double& steps, Sampler& random) {
    const List<Place> places = places_of(barred, steps, random);
    for (int round = 0; round < 2; ++round) {
      const double some = std::min(steps_of_price, gains_.lasts());
      price_ = of_price * gains_.lost_by(some, belief_.weights()) / some;
      List<TestPlan> plans;
      weighed_.clear();
      for (const Place& place : places) {
        if (place.prefix.empty()) add_here(plans, place, steps);
        else add_trip(plans, place, steps);
      }
      const bool is_whole = steps > 0 && !tests_.clock().is_over();
      if (round == 0 || is_whole) gains_.take_plans(std::move(plans), weighed_);
    }
  }

 private:
  using Options = List<std::size_t>;
  static constexpr std::size_t most_options = 8;  // of a choice
  static constexpr std::size_t most_places = 4;   // elsewhere
  static constexpr std::size_t most_tests_tried = 3;
  static constexpr std::size_t most_plans = 300;  // after what has been reported
  static constexpr double of_information = 0.5;   // that a test of a choice tells of it
  static constexpr double of_product = 0.0005;    // steps
  static constexpr double steps_of_price = 4;     // before a deadline that are lost, to tell what one of them is worth
  static constexpr double of_price = 0.8;         // so that the plan that sets the price keeps a gain
  static constexpr int draws = 6;                 // of reports that are too many to list

  // Where the same actions lead all options that end there with one more.
  struct Place {
    Option prefix;
    List<double> paid;  // for that, by state
    double value = 0;   // of the options, each in the states where it earns
    double discount = 1;
    List<StoppingTest> tests{};
    Options options{};
  };

  // Here, and where most can be earned if the state is seen.
  List<Place> places_of(const BarredActions& barred, double& steps, Sampler& random) {
    List<std::pair<double, std::size_t>> by_value;
    for (std::size_t o = 0; o < gains_.size(); ++o) {
      const double value = belief_.mean([&](std::size_t k) { return std::max(gains_.earned_in(o, k), 0.0); });
      if (value > 0 && !gains_.ends(o) && !barred.contains(gains_.way(o).front())) by_value.emplace_back(value, o);
    }
    sort_stably(by_value, [](const auto& one, const auto& other) { return one.first > other.first; });
    List<Place> places;
    places.push_back({{}, List<double>(belief_.size())});
    for (const auto& [value, o] : by_value) {
      places.front().options.push_back(o);
      if (gains_.way(o).size() == 1) continue;
      const Option prefix(gains_.way(o).begin(), gains_.way(o).end() - 1);
      const std::size_t p = std::ranges::find(places, prefix, &Place::prefix) - places.begin();
      if (p > most_places) continue;
      if (p == places.size()) places.push_back({prefix, {}});
      places[p].options.push_back(o);
      places[p].value += value;
    }
    erase_if(places, [&](const Place& place) { return !place.prefix.empty() && !is_elsewhere(place, steps, random); });
    for (const auto& test : tests_.tests()) add_test(places.front(), test.action, test.reward, tests_.reports_of(test.action), steps, random);
    for (Place& place : places) {
      if (!place.prefix.empty()) observe(place, barred, steps, random);
    }
    return places;
  }

  // Whether more is earned at a place by going there first. Else the robot is there already, and would go there for ever: a plan that
  // goes there promises all that is there, which no single choice does.
  bool is_elsewhere(const Place& place, double& steps, Sampler& random) const {
    double at_once = 0;
    for (const std::size_t o : place.options) {
      const Option last{gains_.way(o).back()};
      at_once += belief_.mean([&](std::size_t k) {
        typename Model::State state = belief_.states()[k];
        return std::max(taken_option<Model>(last, state, random, nullptr).earned, 0.0);
      });
    }
    steps -= static_cast<double>(place.options.size() * belief_.size());
    return place.value > at_once;
  }

  // Goes to a place from each state, and takes there what is no move.
  void observe(Place& place, const BarredActions& barred, double& steps, Sampler& random) {
    List<typename Model::State> now = belief_.states();
    bool goes_on = true;
    for (auto& state : now) {
      const OptionOutcome outcome = taken_option<Model>(place.prefix, state, random, nullptr);
      place.paid.push_back(outcome.earned);
      goes_on = goes_on && outcome.goes_on > 0;
    }
    steps -= static_cast<double>(place.prefix.size() * now.size());
    place.discount = std::pow(Model::discount, place.prefix.size());
    List<StepReports> reports(now.size());
    for (int action = 0; goes_on && action < Model::action_count(); ++action) {
      if (barred.contains(action) || tests_.is_move(action) || steps <= 0 || tests_.clock().is_over()) continue;
      const double reward = belief_.mean([&](std::size_t k) {
        typename Model::State state = now[k];
        return step_.take(state, action, reports[k], steps, random);
      });
      add_test(place, action, reward, reports, steps, random);
    }
  }

  void add_test(Place& place, int action, double reward, const List<StepReports>& reports, double& steps, Sampler& random) const {
    const RepeatedObservation observation{reports};
    StoppingTest test{action, reward, observation.likelihoods(), 0};
    if (!observation.is_listed(1)) {
      test.likelihoods = drawn(reports, random);
      steps -= OptionTests<Model>::steps_of_weighing(belief_.size());
    }
    Options states(belief_.size());
    std::iota(states.begin(), states.end(), 0);
    test.information = told_by(test, states, steps);
    if (test.information > OptionTests<Model>::least_information) place.tests.push_back(std::move(test));
  }

  // A few reports that are drawn stand for all, by how near these are to them.
  List<List<double>> drawn(const List<StepReports>& reports, Sampler& random) const {
    List<List<double>> likelihoods;
    StateWeights sums(belief_.size());
    draw_states(belief_.weights(), draws, random, [&](std::size_t k) {
      const Seen seen = reports[k].drawn(random);
      List<double>& of_states = likelihoods.emplace_back();
      for (const StepReports& report : reports) of_states.push_back(report.likelihood(seen));
      const double mean = belief_.mean([&](std::size_t i) { return of_states[i]; });
      for (std::size_t i = 0; i < of_states.size(); ++i) sums[i] += of_states[i] /= mean;
    });
    for (auto& of_states : likelihoods) {
      for (std::size_t i = 0; i < of_states.size(); ++i) of_states[i] = sums[i] > 0 ? of_states[i] / sums[i] : 1.0 / draws;
    }
    return likelihoods;
  }

  // What a test tells of the group that a state belongs to, in nats.
  double told_by(const StoppingTest& test, const Options& group, double& steps) const {
    const StateWeights& weights = belief_.weights();
    StateWeights shares(weights.size() + most_options);
    for (std::size_t k = 0; k < weights.size(); ++k) shares[group[k]] += weights[k];
    double told = 0;
    for (const auto& likelihoods : test.likelihoods) {
      StateWeights joint(shares.size());
      for (std::size_t k = 0; k < weights.size(); ++k) joint[group[k]] += weights[k] * likelihoods[k];
      const double sum = std::accumulate(joint.begin(), joint.end(), 0.0);
      for (std::size_t i = 0; i < joint.size(); ++i) told += joint[i] > 0 ? joint[i] * std::log(joint[i] / (sum * shares[i])) : 0;
    }
    steps -= of_product * static_cast<double>(test.likelihoods.size() * weights.size());
    return told;
  }

  // Calls `use` with the options of a place that change the same, but for what all change that lead there.
  void for_each_choice(const Place& place, auto&& use) const {
    std::vector<bool> is_known(gains_.size());
    for (const std::size_t first : place.options) {
      if (is_known[first]) continue;
      Options options{first};
      for (const std::size_t other : place.options) {
        if (other == first || !gains_.touch(other, first, place.prefix.empty() ? nullptr : &place.options)) continue;
        is_known[other] = true;
        if (options.size() < most_options) options.push_back(other);
      }
      use(options);
    }
  }

  void add_here(List<TestPlan>& plans, const Place& here, double& steps) {
    for_each_choice(here, [&](const Options& options) {
      Options choices;
      for (const std::size_t o : options) {
        const std::size_t choice = gains_.with_tests_there(o);
        if (std::ranges::find(choices, choice) == choices.end()) choices.push_back(choice);
      }
      StoppingPlan plan = stopped(here, choices, gains_.best(belief_.weights(), options.front()), steps);
      if (plan.test == nullptr) return;
      Option way = gains_.way(options.front());
      way.insert(way.begin(), plan.test->action);
      plans.push_back({std::move(way), options, std::move(plan.as)});
    });
  }

  // Goes to a place and makes all choices there, one after the other.
  void add_trip(List<TestPlan>& plans, const Place& place, double& steps) {
    TestPlan trip{place.prefix, {}, {place.paid, StateWeights(belief_.size(), 1.0), place.discount, static_cast<double>(place.prefix.size())}};
    bool is_tested = false;
    for_each_choice(place, [&](const Options& options) {
      const auto [value, test, as] = stopped(place, options, 0, steps);
      if (as.steps <= 0 || trip.as.steps + as.steps > gains_.lasts()) return;
      is_tested = is_tested || test != nullptr;
      trip.options.insert(trip.options.end(), options.begin(), options.end());
      for (std::size_t k = 0; k < belief_.size(); ++k) {
        trip.as.earned[k] += trip.as.discount * as.earned[k];
        trip.as.goes_on[k] *= as.goes_on[k];
      }
      trip.as.discount *= as.discount;
      trip.as.steps += as.steps;
    });
    if (is_tested) plans.push_back(std::move(trip));
  }

  // What is best where a choice is made at a place; without steps where nothing is.
  StoppingPlan stopped(const Place& place, const Options& options, double rest, double& steps) {
    if (steps <= 0 || tests_.clock().is_over()) return {};
    List<StoppingChoice> choices;
    for (const std::size_t o : options) {
      choices.push_back({{}, {}, gains_.discount(o) / place.discount, gains_.length(o) - static_cast<double>(place.prefix.size())});
      for (std::size_t k = 0; k < belief_.size(); ++k) {
        choices.back().earned.push_back((gains_.earned_in(o, k) - place.paid[k]) / place.discount);
        choices.back().goes_on.push_back(gains_.goes_on_in(o, k));
      }
    }
    const List<const StoppingTest*> tests = telling(place, choices, steps);
    if (!tests.empty()) weighed_.insert(weighed_.end(), options.begin(), options.end());
    std::size_t responses = 0;
    for (const StoppingTest* test : tests) responses += test->likelihoods.size();
    int most_tests = 1;
    for (std::size_t all = responses * responses; responses > 1 && all <= most_plans; all *= responses) ++most_tests;
    double shortest = gains_.lasts();
    for (const StoppingChoice& choice : choices) shortest = std::min(shortest, choice.steps);
    const double fit = gains_.lasts() - static_cast<double>(place.prefix.size()) - shortest;
    most_tests = static_cast<int>(std::clamp<double>(fit, 0, most_tests));
    OptimalStopping stopping{choices, tests, Model::discount, rest, price_};
    StoppingPlan plan = stopping.plan(belief_.weights(), most_tests);
    steps -= of_product * static_cast<double>(stopping.plans() * belief_.size() * (choices.size() + tests.size()));
    return plan;
  }

  // Of each skill the test that tells most of which choice is best, if it tells of little else.
  List<const StoppingTest*> telling(const Place& place, const List<StoppingChoice>& choices, double& steps) const {
    Options best(belief_.size(), choices.size());
    for (std::size_t k = 0; k < belief_.size(); ++k) {
      double most = 0;
      for (std::size_t i = 0; i < choices.size(); ++i) {
        if (choices[i].earned[k] > most) best[k] = i;
        most = std::max(most, choices[i].earned[k]);
      }
    }
    List<std::pair<double, const StoppingTest*>> found(Model::skill_count, {0.0, nullptr});
    for (const StoppingTest& test : place.tests) {
      const double told = told_by(test, best, steps);
      auto& of_skill = found[Model::skill_of(test.action)];
      if (told > std::max(of_skill.first, of_information * test.information)) of_skill = {told, &test};
    }
    sort_stably(found, [](const auto& one, const auto& other) { return one.first > other.first; });
    List<const StoppingTest*> tests;
    for (const auto& [told, test] : found) {
      if (test != nullptr && tests.size() < most_tests_tried) tests.push_back(test);
    }
    return tests;
  }

  const SampledBelief<Model>& belief_;
  OptionGains<Model>& gains_;
  const OptionTests<Model>& tests_;
  ReportedStep<Model> step_;
  double price_ = 0;  // of a step before a deadline
  Options weighed_;
};

}
