// Ways to rewards that ask for many conditions at once, and ways in a world that changes by itself: option_search.hpp, option_library.hpp.
#include "aos/planning/options/option_search.hpp"

#include "aos/planning/options/option_library.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::option_search_tests {

constexpr std::size_t dials = 5;
constexpr std::uint32_t digits = 4;
constexpr std::uint32_t right = 2;

// A lock that opens when all dials are right. It says how many are, if it says anything.
// Action d turns dial d on by one, and the last action pulls.
Problem lock(bool says_how_many) {
  std::uint32_t states = 1;
  for (std::size_t dial = 0; dial < dials; ++dial) states *= digits;
  Problem problem = world(states + 1, dials + 1, 0.95);
  problem.horizon = 60;
  problem.variables = dials;
  problem.values.assign((states + 1) * dials, static_cast<int>(digits));
  problem.endings[states] = 1;
  for (std::uint32_t state = 0; state < states; ++state) {
    std::uint32_t place = 1;
    std::size_t met = 0;
    for (std::size_t dial = 0; dial < dials; ++dial, place *= digits) {
      const std::uint32_t digit = state / place % digits;
      problem.values[state * dials + dial] = static_cast<int>(digit);
      met += digit == right ? 1 : 0;
      const std::uint32_t turned = state - digit * place + (digit + 1) % digits * place;
      row(problem, state, dial) = {{1.0, turned, 0, -0.1}};
    }
    const bool is_right = met == dials;
    if (says_how_many) problem.conditions.push_back(static_cast<int>(met));
    row(problem, state, dials) = {{1.0, is_right ? states : state, 0, is_right ? 50.0 : -1.0}};
  }
  if (says_how_many) problem.conditions.push_back(0);  // of the end
  return problem;
}

aos::List<aos::Option> ways(const Problem& problem, double& steps) {
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  aos::LeafCells<TableModel> cells;
  cells.prepare(belief, random);
  const aos::DecisionClock clock;
  aos::RunningDown<TableModel> running_down;
  running_down.find(belief, random);
  aos::OptionSearch<TableModel> search{cells, clock, &running_down, TableModel::has_goal_conditions};
  return search.from(belief.particles().front().state, steps, random);
}

TEST("A way to a reward that asks for five conditions is found by how many of them hold") {
  const Problem problem = lock(true);
  double steps = 20'000;
  const auto found = ways(problem, steps);
  EXPECT(!found.empty());
  if (!found.empty()) EXPECT_EQUAL(found.front().size(), right * dials + 1);
  EXPECT(steps > 18'000);
}

TEST("No new value and no new pair of values leads to a reward that asks for five conditions") {
  const Problem problem = lock(false);
  double steps = 20'000;
  EXPECT(ways(problem, steps).empty());
}

TEST("An exit that earns nothing ends no search for what pays, and a search heeds what no walk has changed") {
  double steps = 20'000;
  const Problem problem = corridor_with_exits(6, 3);
  const auto found = ways(problem, steps);
  EXPECT((!found.empty() && found.front() == aos::Option(6, 3)));
  aos::Sampler random{1};
  aos::LeafCells<TableModel> cells;
  cells.prepare(Belief::initial(random), random);
  EXPECT_EQUAL(cells.with_resting().size(), cells.size() + 1);
}

// A square of `side` by `side` places in a wind of 40 directions, which turns as it likes. Actions 0 and 1 lead on in one dimension each.
// Action 2 earns 10 in the far corner, and ends the mission.
Problem windy_square(std::uint32_t side) {
  constexpr std::uint32_t winds = 40;
  const std::uint32_t end = side * side * winds;
  Problem problem = world(end + 1, 3, 0.95);
  problem.variables = 3;
  problem.values.assign(problem.variables * (end + 1), 0);
  problem.endings[end] = 1;
  for (std::uint32_t state = 0; state < end; ++state) {
    const std::uint32_t wind = state % winds, x = state / winds % side, y = state / winds / side;
    std::ranges::copy(std::array{x, y, wind}, problem.values.begin() + problem.variables * state);
    const std::array<std::uint32_t, 3> next{y * side + std::min(x + 1, side - 1), std::min(y + 1, side - 1) * side + x, y * side + x};
    for (std::size_t action = 0; action < next.size(); ++action) {
      row(problem, state, action).clear();
      for (std::uint32_t turned = 0; turned < winds; ++turned) row(problem, state, action).push_back({1.0 / winds, next[action] * winds + turned, 0, -0.1});
    }
    if (next[2] == side * side - 1) row(problem, state, 2) = {{1.0, end, 0, 10}};
  }
  return problem;
}

// What share of at most `count` states with which a problem begins has a way for a library that may take so many steps, and how many it takes.
struct Extended {
  double share;
  double taken;
};
Extended extended(const Problem& problem, std::size_t count, double steps, bool knows_the_world) {
  const Belief belief = initial_belief(problem);
  aos::Sampler random{1};
  const aos::DecisionClock clock;
  aos::OptionLibrary<TableModel> library{clock};
  library.prepare(belief, random);
  aos::SampledBelief<TableModel> sampled;
  sampled.draw(belief, count, random);
  double measured = 0;
  aos::OwnChanges<TableModel> changes;
  changes.measure(sampled.states(), library.cells(), measured, random);
  if (knows_the_world) library.look_first_at_own(changes);
  double left = steps;
  const double share = library.extend(sampled, left, random);
  return {share, steps - left};
}

// The steps of the model until a library has a way from the state with which a problem begins, where it knows what the world changes, and where not.
double steps_to_a_way(const Problem& problem, bool knows_the_world) {
  const Extended found = extended(problem, 1, 100'000, knows_the_world);
  EXPECT(found.share == 1);
  return found.taken;
}

TEST("A search for ways goes by what the robot changes, and not by the wind") {
  const Problem problem = windy_square(6);
  EXPECT(steps_to_a_way(problem, true) < 0.7 * steps_to_a_way(problem, false));
}

// A level that each of three actions moves by -1, 0 or 1, each by other luck than the next one. The last action raises it by as much as `raised` besides.
Problem drifting(std::uint32_t raised) {
  constexpr std::uint32_t levels = 60;
  Problem problem = world(levels, 3, 0.95);
  start_evenly(problem, 20, 40);
  for (std::uint32_t level = 1; level + 3 < levels; ++level) {
    for (std::uint32_t action = 0; action < 3; ++action) {
      auto& outcomes = row(problem, level, action);
      outcomes.clear();
      for (std::uint32_t n = 0; n < 3; ++n) outcomes.push_back({1.0 / 3, level - 1 + (action + n) % 3 + (action == 2 ? raised : 0), 0, -0.1});
    }
  }
  return problem;
}

TEST("What chance changes after all actions alike is the world's, though each action draws it by itself, and what one of them raises is not") {
  for (const std::uint32_t raised : {0U, 1U}) {
    const Problem problem = drifting(raised);
    const Belief belief = initial_belief(problem);
    aos::Sampler random{1};
    aos::LeafCells<TableModel> cells;
    cells.prepare(belief, random);
    aos::SampledBelief<TableModel> sampled;
    sampled.draw(belief, 20, random);
    double steps = 0;
    aos::OwnChanges<TableModel> changes;
    changes.measure(sampled.states(), cells, steps, random);
    EXPECT_EQUAL(changes.is_worlds(0), raised == 0);
    EXPECT_EQUAL(changes.is_move(2), raised == 1);
  }
}

TEST("Where the world has to change before anything is earned, a search for ways waits for it") {
  Problem tides = world(7, 2, 0.95);
  tides.endings[6] = 1;
  for (std::uint32_t tide = 0; tide < 6; ++tide) {
    row(tides, tide, 0) = {{1.0, (tide + 1) % 6, 0, -0.1}};
    row(tides, tide, 1) = {{1.0, tide == 3 ? 6 : (tide + 1) % 6, 0, tide == 3 ? 10.0 : -1.0}};
  }
  EXPECT(steps_to_a_way(tides, true) < 1'000);
}

// A square of `side` by `side` places. Actions 0 to 3 lead on in one dimension each, action 4 takes what lies in the middle, and action 5 earns 10 where it is
// put down at the start, which ends the mission.
Problem carried_in_a_square(std::uint32_t side) {
  const std::uint32_t end = 2 * side * side;
  Problem problem = world(end + 1, 6, 0.95);
  problem.variables = 3;
  problem.values.assign(problem.variables * (end + 1), 0);
  problem.endings[end] = 1;
  for (std::uint32_t state = 0; state < end; ++state) {
    const std::uint32_t carries = state % 2, x = state / 2 % side, y = state / 2 / side;
    std::ranges::copy(std::array{x, y, carries}, problem.values.begin() + problem.variables * state);
    const auto at = [&](std::uint32_t to_x, std::uint32_t to_y, std::uint32_t then) { return 2 * (to_y * side + to_x) + then; };
    const bool is_there = x == side / 2 && y == side / 2;
    const std::array<std::uint32_t, 6> next{at(std::min(x + 1, side - 1), y, carries), at(x, std::min(y + 1, side - 1), carries), at(x - std::min(x, 1U), y, carries),
                                            at(x, y - std::min(y, 1U), carries), is_there ? at(x, y, 1) : state, state};
    for (std::size_t action = 0; action < next.size(); ++action) row(problem, state, action) = {{1.0, next[action], 0, -0.1}};
    if (state == 1) row(problem, state, 5) = {{1.0, end, 0, 10}};
  }
  return problem;
}

TEST("What is carried across a square is brought back, where no new pair of values leads back") {
  const Problem problem = carried_in_a_square(7);
  double steps = 20'000;
  EXPECT(ways(problem, steps).empty());
  EXPECT(steps_to_a_way(problem, true) < 5'000);
}

TEST("States that no step is left to search from do not count as without a way") {
  Problem problem = corridor(12, 0.95);
  start_evenly(problem, 0, 8);
  EXPECT(extended(problem, 8, 1, false).share == 1);
}

}
