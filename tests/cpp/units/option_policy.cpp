// What options decide in a world that is small enough for the exact value: option_policy.hpp, option_pairs.hpp.
#include "aos/planning/options/option_policy.hpp"

#include "aos/planning/listed/state_space.hpp"
#include "check.hpp"
#include "numbers/exact.hpp"
#include "numbers/observable_values.hpp"
#include "worlds.hpp"

namespace units::option_policy_tests {

constexpr int look = 0, go = 1, take = 2;

// Two rooms, in each of which a thing may be. To look tells of the room where the robot is. To take the thing earns 10, and 6 is lost
// where there is none. A state has a bit for the room, two for the things, and two for those that are taken.
Problem two_rooms(double first, double second) {
  Problem problem = world(32, 3, 0.95);
  hear(problem, 0.85);
  problem.starts.clear();
  for (const std::uint32_t one : {0u, 1u}) {
    for (const std::uint32_t other : {0u, 1u}) {
      problem.starts.push_back({2 * one + 4 * other, (one ? first : 1 - first) * (other ? second : 1 - second)});
    }
  }
  for (std::uint32_t state = 0; state < 32; ++state) {
    const std::uint32_t room = state & 1, thing = 2u << room, taken = 8u << room;
    const bool is_there = (state & thing) && !(state & taken);
    row(problem, state, look) = {{1.0, state, is_there ? 1u : 2u, -0.2}};
    row(problem, state, go) = {{1.0, state ^ 1u, 0, -1}};
    row(problem, state, take) = {{1.0, is_there ? state | taken : state, 0, is_there ? 10.0 : -6.0}};
  }
  return problem;
}

// What each action is worth with so many decisions to go.
aos::List<aos::ExactValue> exact_values(const Belief& belief, int decisions) {
  aos::StateSpace<TableModel> space;
  space.reach(belief);
  const aos::ObservableValues observable{space.rows(), space.numbering(), decisions};
  aos::ExactEvaluation evaluation{space.rows(), observable, {.beliefs = 1'000'000}};
  return evaluation.action_values(space.exact_weights_of(belief), decisions);
}

// What options tell of each action at the first belief of a problem.
auto told_by_options(const Problem& problem, const Belief& belief) {
  aos::Sampler random{1};
  aos::OptionPolicy<TableModel> policy;
  EXPECT(policy.prepare(belief, problem.horizon, 1e6, 0, random).empty());
  policy.search(belief, problem.horizon, random, {});
  return policy.estimates();
}

TEST("Before a robot leaves for what may be better elsewhere it looks where it is") {
  for (const double first : {0.3, 0.5, 0.6}) {
    const Problem problem = two_rooms(first, 0.7);
    const Belief belief = initial_belief(problem);
    const auto exact = exact_values(belief, 7);
    EXPECT(exact[look].value > std::max(exact[go].value, exact[take].value) + 0.3);
    const auto estimates = told_by_options(problem, belief);
    EXPECT(estimates[look].q > std::max(estimates[go].q, estimates[take].q));
  }
}

TEST("A look that had no time is gone on with, whatever it takes") {
  const Problem problem = two_rooms(0.5, 0.7);
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  aos::OptionPolicy<TableModel> policy;
  EXPECT(!policy.prepare(belief, problem.horizon, 1e6, 1e-9, random).empty());
  EXPECT(!policy.knows_ways());
  policy.look_on(random);
  EXPECT(policy.knows_ways());
}

// Fourteen switches, of which the first six may be on. A report says whether the first one is. The last action ends the mission, which pays 50 if all are
// on, and costs 15 else.
TEST("The first look leaves time to count conditions, since the robot may leave for good after it") {
  constexpr std::uint32_t switches = 14, end = 1u << switches, last = switches + 1;
  Problem problem = world(end + 1, last + 1, 0.98);
  problem.horizon = 40;
  problem.variables = switches;
  problem.values.assign((end + 1) * switches, 0);
  problem.endings[end] = 1;
  hear(problem, 0.9);
  start_evenly(problem, 0, 64);
  for (std::uint32_t state = 0; state < end; ++state) {
    for (std::uint32_t each = 0; each < switches; ++each) {
      problem.values[state * switches + each] = static_cast<int>(state >> each & 1);
      row(problem, state, each) = {{1.0, state | 1u << each, 0, -0.3}};
    }
    row(problem, state, switches) = {{1.0, state, 1 + (state & 1), -0.1}};
    row(problem, state, last) = {{1.0, end, 0, state + 1 == end ? 50.0 : -15.0}};
    problem.conditions.push_back(std::popcount(state));
  }
  problem.conditions.push_back(0);
  aos::Sampler random{1};
  aos::OptionPolicy<TableModel> policy;
  EXPECT(policy.prepare(initial_belief(problem), problem.horizon, 1e5, 0, random).empty());
}

// A thing is in one of 15 rooms, but not in the first one, where the robot is. No look pays for itself, and each step costs 1.
TEST("A robot looks elsewhere before it looks for ever where it knows that nothing is") {
  constexpr std::uint32_t rooms = 15, end = rooms * rooms;
  Problem problem = world(end + 2, 3, 0.98);
  problem.endings[end] = 1;
  problem.endings[end + 1] = 2;
  problem.horizon = 40;
  hear(problem, 0.95);
  start_evenly(problem, 1, rooms);
  for (std::uint32_t state = 0; state < end; ++state) {
    const std::uint32_t room = state / rooms, thing = state % rooms;
    row(problem, state, look) = {{1.0, state, room == thing ? 1u : 2u, -1}};
    row(problem, state, go) = {{1.0, (room + 1) % rooms * rooms + thing, 0, -1}};
    row(problem, state, take) = {{1.0, room == thing ? end : end + 1, 0, room == thing ? 20.0 : -20.0}};
  }
  const auto estimates = told_by_options(problem, initial_belief(problem));
  EXPECT(estimates[go].q > estimates[look].q);
}

// A thing is in one of the rooms 1 to 19, and the robot, which can go to each of them, begins in room 0.
TEST("Where a robot begins at a place without anything to see, what it can see elsewhere counts") {
  constexpr std::uint32_t rooms = 20, looks = rooms, takes = rooms + 1, end = rooms * rooms;
  Problem problem = world(end + 1, takes + 1, 0.98);
  problem.endings[end] = 1;
  hear(problem, 0.95);
  start_evenly(problem, 1, rooms);
  for (std::uint32_t state = 0; state < end; ++state) {
    const std::uint32_t room = state / rooms, thing = state % rooms;
    for (std::uint32_t to = 0; to < rooms; ++to) row(problem, state, to) = {{1.0, to * rooms + thing, 0, -0.5}};
    row(problem, state, looks) = {{1.0, state, room == thing ? 1u : 2u, -0.1}};
    row(problem, state, takes) = {{1.0, room == thing ? end : state, 0, room == thing ? 20.0 : -5.0}};
  }
  aos::Sampler random{1};
  aos::OptionPolicy<TableModel> policy;
  EXPECT(policy.prepare(initial_belief(problem), problem.horizon, 1e6, 0, random).empty());
}

// A bell ends the mission where all is ready, and else costs 5 at each step from then on. Bit 0: all is ready; bit 1: the bell was rung.
TEST("What an option leaves behind counts up to the horizon") {
  constexpr std::uint32_t ring = 1, end = 4;
  Problem problem = world(end + 1, ring + 1, 0.98);
  problem.endings[end] = 1;
  problem.horizon = 20;
  hear(problem, 0.9);
  problem.starts = {{0, 0.1}, {1, 0.9}};
  for (std::uint32_t state = 0; state < end; ++state) {
    const bool is_ready = state & 1;
    const double cost = state & 2 ? -5 : 0;
    row(problem, state, look) = {{1.0, state, is_ready ? 1u : 2u, cost - 1}};
    row(problem, state, ring) = {{1.0, is_ready ? end : state | 2u, 0, cost + (is_ready ? 10.0 : -1.0)}};
  }
  const Belief belief = initial_belief(problem);
  const auto exact = exact_values(belief, 12);
  EXPECT(exact[look].value > exact[ring].value + 1);
  const auto estimates = told_by_options(problem, belief);
  EXPECT(estimates[look].q > estimates[ring].q);
}

// A thing is in one of 48 places, of which a scan covers twelve. No scan makes any place worth a try. Another test tells for less what is of no use.
TEST("A scan counts for the tests that it makes cheaper, and what is of no use counts nothing") {
  constexpr std::uint32_t places = 48, scans = 4, of_no_use = scans, first_peek = scans + 1, first_take = first_peek + places;
  Problem problem = world(2 * places + 1, first_take + places, 0.98);
  problem.endings[2 * places] = 1;
  problem.horizon = 60;
  hear(problem, 0.9);
  start_evenly(problem, 0, 2 * places);
  for (std::uint32_t state = 0; state < 2 * places; ++state) {
    const std::uint32_t thing = state / 2;
    for (std::uint32_t scan = 0; scan < scans; ++scan) row(problem, state, scan) = {{1.0, state, thing % scans == scan ? 1u : 2u, -1}};
    row(problem, state, of_no_use) = {{1.0, state, 1 + state % 2, -0.1}};
    for (std::uint32_t place = 0; place < places; ++place) {
      row(problem, state, first_peek + place) = {{1.0, state, place == thing ? 1u : 2u, -0.5}};
      row(problem, state, first_take + place) = {{1.0, place == thing ? 2 * places : state, 0, place == thing ? 30.0 : -8.0}};
    }
  }
  const auto estimates = told_by_options(problem, initial_belief(problem));
  const auto best = std::ranges::max_element(estimates, {}, [](const aos::ActionEstimate& estimate) { return estimate.n > 0 ? estimate.q : -1e9; });
  EXPECT(best - estimates.begin() < scans);
}

// A machine earns at each step, and all that changes it costs more.
TEST("What a step earns that changes nothing is told apart from what ways earn") {
  for (const double idle : {0.5, 0.0}) {
    Problem problem = world(2, 5, 0.95);
    problem.starts = {{0, 0.5}, {1, 0.5}};
    for (std::uint32_t state = 0; state < 2; ++state) {
      for (int action = 0; action < 5; ++action) {
        const bool is_idle = action < 2;
        row(problem, state, action) = {{1.0, is_idle ? state : 1 - state, 0, is_idle ? idle : action == 2 ? 1.0 : -1.0}};
      }
    }
    aos::Sampler random{1};
    aos::OptionPolicy<TableModel> policy;
    EXPECT(policy.prepare(initial_belief(problem), problem.horizon, 1e5, 0, random).empty());
    EXPECT(policy.earns_idle() == (idle > 0));
    EXPECT(!policy.earns_anyway());
  }
}

// Two jobs, each done by its action, which earns 20; the mission ends when both are done. A state has a bit for each.
// What ways are searched for with, from a belief, with luck that is always the same.
struct Ways {
  explicit Ways(const Belief& belief) { library.prepare(belief, random); }

  aos::Sampler random{1};
  const aos::DecisionClock clock;
  aos::OptionLibrary<TableModel> library{clock};
  aos::SampledBelief<TableModel> sampled;
};

TEST("A reward that an action has earned does not count again where the mission may end with it") {
  Problem problem = world(4, 2, 0.95);
  problem.starts = {{0, 0.4}, {1, 0.3}, {2, 0.3}};
  problem.values = {0, 0, 1, 0, 0, 1, 1, 1};
  problem.endings[3] = 1;
  for (std::uint32_t state = 0; state < 3; ++state) {
    for (const std::uint32_t job : {0u, 1u}) {
      if (!(state & 1u << job)) row(problem, state, job) = {{1.0, state | 1u << job, 0, 20}};
    }
  }
  const Belief belief = initial_belief(problem);
  Ways ways{belief};
  auto& [random, clock, library, sampled] = ways;
  sampled.draw(belief, 30, random);
  double steps = 10'000;
  library.extend(sampled, steps, random);
  aos::OwnChanges<TableModel> changes;
  changes.measure(sampled.states(), library.cells(), steps, random);
  aos::OptionGains<TableModel> gains;
  gains.measure(library, sampled, static_cast<double>(sampled.size()), changes, {}, steps, random);
  for (std::size_t k = 0; k < sampled.size(); ++k) {
    const bool is_one_done = sampled.states()[k].variables[0] + sampled.states()[k].variables[1] == 1;
    EXPECT(gains.best_in(k) >= 20);
    EXPECT(gains.best_in(k) <= (is_one_done ? 20 : 20 + 0.95 * 20) + 1e-9);
  }
}

// One of 50 things is wanted, the first one by 0.6, and all have worn as far as chance has it.
TEST("How far a state that stands for others has worn moves no weight") {
  constexpr std::uint32_t things = 50, wears = 4;
  Problem problem = world(things * wears, 2, 0.95);
  problem.starts.clear();
  for (std::uint32_t state = 0; state < things * wears; ++state) {
    const std::uint32_t thing = state / wears, wear = state % wears;
    problem.values[2 * state] = static_cast<int>(thing);
    problem.values[2 * state + 1] = static_cast<int>(wear);
    problem.starts.push_back({state, (thing == 0 ? 0.6 : 0.4 / (things - 1)) / wears});
    for (const std::uint32_t action : {0u, 1u}) {
      if (wear + 1 < wears) row(problem, state, action) = {{1.0, state + 1, 0, 0}};
    }
  }
  const Belief belief = initial_belief(problem);
  Ways ways{belief};
  auto& [random, clock, library, sampled] = ways;
  using State = TableModel::State;
  sampled.draw_alike(belief, 64, [](const State& state) { return static_cast<std::uint64_t>(state.variables[0]); }, random);
  sampled.rake(belief, library.searched_cells(), [](State& state) { state.variables[1] = 0; }, random);
  EXPECT_EQUAL(sampled.size(), things);
  for (std::size_t k = 0; k < sampled.size(); ++k) {
    if (sampled.states()[k].variables[0] == 0) EXPECT_NEAR(sampled.weights()[k], 0.6, 0.01);
  }
}

// Two things of two kinds. To test one tells of it and costs little, and each may be kept or thrown away, once, where the robot is not far from them. To go there
// costs what it does. A state has a bit for the kind of each thing, one for whether it is done, and one for whether the robot is far.
Problem two_things(double odds, double of_way) {
  constexpr int things = 2, go = 3 * things;
  constexpr std::uint32_t far = 16;
  Problem problem = world(32, go + 1, 0.95);
  hear(problem, 0.75);
  problem.starts.clear();
  problem.values.clear();
  problem.variables = 2 * things + 1;
  for (std::uint32_t state = 0; state < 32; ++state) {
    for (int bit = 0; bit < problem.variables; ++bit) problem.values.push_back(state >> bit & 1);
    if ((state >> things) == (of_way < 0 ? 4u : 0u)) problem.starts.push_back({state, (state & 1 ? odds : 1 - odds) / 2});
    const bool is_far = state & far;
    row(problem, state, go) = {{1.0, state & ~far, 0, is_far ? of_way : -1.0}};
    for (int thing = 0; thing < things; ++thing) {
      const std::uint32_t kind = state >> thing & 1, done = 4u << thing;
      const bool is_in_vain = is_far || (state & done);
      row(problem, state, thing) = {{1.0, state, is_in_vain ? 0 : 1 + kind, -0.2}};
      row(problem, state, things + thing) = {{1.0, is_in_vain ? state : state | done, 0, is_in_vain ? -1.0 : kind ? 6.0 : -6.0}};
      row(problem, state, 2 * things + thing) = {{1.0, is_in_vain ? state : state | done, 0, is_in_vain ? -1.0 : kind ? -2.0 : 2.0}};
    }
  }
  return problem;
}

// What the action that is chosen is worth less than the best one.
double lost_by_options(const Problem& problem) {
  const Belief belief = initial_belief(problem);
  const auto exact = exact_values(belief, 9);
  const auto estimates = told_by_options(problem, belief);
  const auto best = std::ranges::max_element(estimates, {}, &aos::ActionEstimate::q) - estimates.begin();
  return std::ranges::max_element(exact, {}, &aos::ExactValue::value)->value - exact[best].value;
}

TEST("A thing is tested as often as is worth it before it is done, whatever else can be tested") {
  for (const double odds : {0.5, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95}) EXPECT(lost_by_options(two_things(odds, 0)) < 0.1);
}

TEST("A robot goes to things that are worth the way once they are tested") {
  for (const double of_way : {-0.5, -1.0, -2.0, -2.5}) EXPECT(lost_by_options(two_things(0.5, of_way)) < 0.1);
}

TEST("What is told is what plans of tests return, and what it costs to wait after them") {
  for (const double odds : {0.5, 0.6, 0.7, 0.8}) {
    Problem problem = two_things(odds, 0);
    problem.horizon = 9;
    const Belief belief = initial_belief(problem);
    const auto estimates = told_by_options(problem, belief);
    const double told = std::ranges::max_element(estimates, {}, &aos::ActionEstimate::q)->q;
    const auto exact = exact_values(belief, problem.horizon);
    EXPECT(std::abs(told - std::ranges::max_element(exact, {}, &aos::ExactValue::value)->value) < 0.5);
  }
}

// A thing is in one of two places, or in neither. To take it there earns 3, elsewhere 30 are lost, and to look costs 5. To leave earns 2.
TEST("Of an end that is taken is told what it earns") {
  constexpr std::uint32_t leave = 3, end = 3;
  Problem problem = units::world(end + 1, leave + 1, 0.95);
  problem.endings[end] = 1;
  units::hear(problem, 0.7);
  problem.starts = {{0, 0.4}, {1, 0.4}, {2, 0.2}};
  for (std::uint32_t state = 0; state < end; ++state) {
    units::row(problem, state, look) = {{1.0, state, 1 + state % 2, -5}};
    for (const std::uint32_t place : {0u, 1u}) units::row(problem, state, 1 + place) = {{1.0, end, 0, place == state ? 3.0 : -30.0}};
    units::row(problem, state, leave) = {{1.0, end, 0, 2}};
  }
  const auto estimates = told_by_options(problem, initial_belief(problem));
  EXPECT(std::ranges::max_element(estimates, {}, &aos::ActionEstimate::q) - estimates.begin() == leave);
  EXPECT(std::abs(estimates[leave].q - 2) < 1e-9);
}

TEST("What is earned by luck is told with the error of the tries") {
  Problem problem = units::world(2, 1, 0.95);
  problem.endings[1] = 1;
  units::row(problem, 0, take - 2) = {{0.5, 1, 0, 10}, {0.5, 1, 0, 0}};
  const auto told = told_by_options(problem, initial_belief(problem)).front();
  EXPECT(told.standard_error > 0.2);
  EXPECT(std::abs(told.q - 5) < 3 * told.standard_error);
}

TEST("A plain plan after which the mission goes on is told with what may still be earned, and one that ends it is not") {
  const Problem problem = two_rooms(0.5, 0.5);
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  aos::OptionPolicy<TableModel> policy;
  policy.prepare(belief, problem.horizon, 1e6, 0, random);
  policy.search(belief, problem.horizon, random, {});
  const double seen = 10;  // at least one thing is there in three of four states
  policy.settle_for({look, -2, 0.1, 0}, 4, 20);
  EXPECT(policy.estimates()[look].q == -2 && policy.estimates()[look].standard_error == 0.1);
  policy.settle_for({look, -2, 0.1, 1}, 4, 20);
  EXPECT(policy.estimates()[look].q == 1);
  EXPECT(policy.estimates()[look].standard_error > (seen / 2 + 2) / 2);
}

// Three things that may be sound, of which each can be tested and taken, once, until a stall closes. A state has a bit for each that is sound and each that is
// taken, and the steps that are left.
Problem three_things(std::uint32_t steps, double of_unsound) {
  constexpr std::uint32_t things = 3, in_all = 64;
  Problem problem = world(in_all * (steps + 1), 2 * things, 0.95);
  problem.sensings.push_back({{0, 0.75}, {1, 0.25}});
  problem.sensings.push_back({{0, 0.25}, {1, 0.75}});
  start_evenly(problem, in_all * steps, in_all * steps + 8);
  problem.values.clear();
  problem.variables = 2 * things + 1;
  for (std::uint32_t state = 0; state < in_all * (steps + 1); ++state) {
    for (std::uint32_t bit = 0; bit < 2 * things; ++bit) problem.values.push_back(state >> bit & 1);
    problem.values.push_back(state / in_all);
    if (state < in_all) problem.endings[state] = 1;
    for (std::uint32_t thing = 0; state >= in_all && thing < things; ++thing) {
      const bool is_sound = state >> thing & 1, is_taken = state >> (things + thing) & 1;
      const std::uint32_t later = state - in_all;
      row(problem, state, thing) = {{1.0, later, is_sound ? 2u : 1u, -0.1}};
      row(problem, state, things + thing) = {{1.0, later | 8u << thing, 0, is_taken ? -1.0 : is_sound ? 8.0 : of_unsound}};
    }
  }
  return problem;
}

TEST("No more is tested than there is time for before a mission is over whatever the robot does") {
  for (const double of_unsound : {-2.0, -4.0, -6.0, -10.0}) {
    for (const std::uint32_t steps : {2u, 3u, 4u, 5u, 6u}) EXPECT(lost_by_options(three_things(steps, of_unsound)) < 0.1);
  }
}

}
