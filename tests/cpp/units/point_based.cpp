// Point-based search on tables: regions, bounds and trials, alias.hpp.
#include <map>

#include "aos/belief/belief.hpp"
#include "aos/draws/alias.hpp"
#include "aos/draws/random.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "check.hpp"
#include "point_based/online.hpp"
#include "point_based/regions.hpp"
#include "worlds.hpp"

namespace units::point_based_tests {

namespace point_based = aos::point_based;

// By the engine's own way to numbers. States are numbered as they are found, so those of the start come first.
point_based::FlatModel flat_model(const Problem& problem) {
  const Belief belief = initial_belief(problem);
  aos::StateSpace<TableModel> space;
  space.reach(belief);
  point_based::FlatModel model = space.rows();
  model.starts.push_back({1, space.weights_of(belief)});
  return model;
}

bool never() { return false; }

// A search at the first belief of the tiger.
struct TigerSearch : point_based::OnlineSarsop {
  TigerSearch() : OnlineSarsop{flat_model(tiger())} { EXPECT(move_to({{0, 0.5}, {1, 0.5}})); }
};

TEST("The first bounds of a corridor enclose its value, and trials close them") {
  for (const std::uint32_t cells : {1u, 2u, 8u, 60u}) {
    const Problem corridor = units::corridor(cells, 0.9);
    point_based::OnlineSarsop search{flat_model(corridor)};
    EXPECT(search.move_to({{0, 1.0}}));
    const double value = 10 * std::pow(0.9, cells - 1);
    const auto before = search.bounds();
    EXPECT(before.first <= value + 1e-12 && value - 1e-12 <= before.second);
    search.improve(3'000'000, never);
    const auto after = search.bounds();
    EXPECT(after.first <= value + 1e-12 && value - 1e-12 <= after.second);
    EXPECT(after.second - after.first <= 2e-3);
  }
}

TEST("The bounds of the tiger close on the value that other programs give") {
  TigerSearch search;
  search.improve(300'000'000, never);
  const auto [lower, upper] = search.bounds();
  EXPECT(lower <= 19.3714 && 19.3713 <= upper);
  EXPECT_NEAR(upper, lower, 0.05);
}

TEST("Bounds come nearer with every trial, and never cross") {
  TigerSearch search;
  auto before = search.bounds();
  for (int trial = 0; trial < 200; ++trial) {
    search.improve(1, never);
    const auto now = search.bounds();
    EXPECT(now.first >= before.first - 1e-9 && now.second <= before.second + 1e-9);
    EXPECT(now.first <= now.second + 1e-9);
    before = now;
  }
}

// A machine that wears down by chance. To run it tells little of the wear, and to look tells all.
constexpr std::uint32_t wears = 4, run = 0, replace = 1, look = 2;
constexpr double wears_down = 0.3;
double chance_of_bad(std::uint32_t wear) { return 0.5 + 0.1 * wear; }
point_based::FlatModel machine(std::size_t horizon) {
  Problem problem = world(wears, 3, 0.95);
  problem.sensings.clear();
  problem.starts.clear();
  for (std::uint32_t wear = 0; wear < wears; ++wear) {
    problem.starts.push_back({wear, 1.0 / wears});  // so that states are numbered as here
    problem.sensings.push_back({{0, 1 - chance_of_bad(wear)}, {1, chance_of_bad(wear)}});
  }
  for (std::uint32_t wear = 0; wear < wears; ++wear) {
    problem.sensings.push_back({{2 + static_cast<int>(wear), 1.0}});
    const double earned = 1 - 0.75 * wear;
    const std::uint32_t worn = std::min(wear + 1, wears - 1);
    row(problem, wear, run) = {{1 - wears_down, wear, wear, earned}, {wears_down, worn, wear, earned}};
    row(problem, wear, replace) = {{1.0, 0, wears, -5.0}};
    row(problem, wear, look) = {{1.0, wear, wears + wear, -1.0}};
  }
  point_based::FlatModel model = flat_model(problem);
  model.horizon = horizon;
  return model;
}

using Weights = aos::List<std::pair<std::uint32_t, double>>;
Weights after_run(const Weights& belief, bool is_bad) {
  double next[wears] = {}, total = 0;
  for (const auto& [wear, probability] : belief) {
    const double seen = probability * (is_bad ? chance_of_bad(wear) : 1 - chance_of_bad(wear));
    next[wear] += (1 - wears_down) * seen;
    next[std::min(wear + 1, wears - 1)] += wears_down * seen;
    total += seen;
  }
  Weights after;
  for (std::uint32_t wear = 0; wear < wears; ++wear) {
    if (next[wear] > 0) after.emplace_back(wear, next[wear] / total);
  }
  return after;
}

TEST("Bounds close at each belief of a mission, also after plans that earlier ones needed were given up") {
  point_based::OnlineSarsop search{machine(22)};
  Weights belief{{0, 1.0}};
  for (int step = 0; step < 8; ++step, belief = after_run(belief, step % 3 == 2)) {
    EXPECT(search.move_to(belief));
    search.improve(100'000'000, never);
    const auto [lower, upper] = search.bounds();
    EXPECT(upper - lower <= 0.01 * std::abs(lower));
    std::uint64_t work = 0;
    search.losses(run, 22, 0, never, work);
  }
}

TEST("With fewer decisions left a search goes on from what it knows, and not with more") {
  point_based::OnlineSarsop search{machine(12)};
  Weights belief{{0, 1.0}};
  EXPECT(search.move_to(belief));
  search.improve(100'000'000, never);
  for (std::size_t left = 11; left > 6; --left) {
    belief = after_run(belief, false);
    EXPECT(search.move_to(belief, left));
    const auto known = search.bounds();
    point_based::OnlineSarsop anew{machine(left)};
    EXPECT(anew.move_to(belief));
    const auto before = anew.bounds();
    anew.improve(100'000'000, never);
    const auto [lower, upper] = anew.bounds();
    EXPECT(known.first <= upper + 1e-9 && lower - 1e-9 <= known.second);
    EXPECT(known.second - known.first < 0.1 * (before.second - before.first));
  }
  EXPECT(!search.move_to(belief, 13));
}

TEST("Each action has bounds of its own, of which the best are those of the belief") {
  TigerSearch search;
  search.improve(3'000'000, never);
  search.open_actions(never);
  const auto actions = search.action_bounds();
  EXPECT_EQUAL(actions.size(), 3u);
  EXPECT(actions[0].lower > actions[1].upper);
  EXPECT_NEAR(actions[0].lower, search.bounds().first, 0.05);
  const double open = -45 + 0.95 * 19.3714;
  EXPECT(actions[1].lower <= open && open <= actions[1].upper);
}

TEST("Without a horizon, missions tell how much of the value comes after the decisions that count") {
  const Problem corridor = units::corridor(8, 0.9);
  for (const auto& [steps, earned] : {std::pair{3u, 0.0}, {8u, 10 * std::pow(0.9, 7)}}) {
    point_based::OnlineSarsop search{flat_model(corridor)};
    search.move_to({{0, 1.0}});
    search.improve(3'000'000, never);
    search.open_actions(never);
    const auto actions = search.action_bounds();
    const std::uint32_t best = actions[0].lower > actions[1].lower ? 0 : 1;
    std::uint64_t work = 0;
    const auto losses = search.losses(best, steps, 0, never, work);
    EXPECT_EQUAL(losses.size(), 30u);
    for (const point_based::MissionLoss& loss : losses) EXPECT_NEAR(actions[best].lower - loss.all - loss.later, earned, 1e-3);
  }
}

TEST("The best of the simple policies listens to the tiger, and returns less than the optimum") {
  TigerSearch search;
  std::uint64_t work = 0;
  const auto policy = search.best_policy(60, {0, never}, work);
  EXPECT(policy.has_value());
  EXPECT_EQUAL(policy->action, 0u);
  EXPECT(policy->value - 3 * policy->standard_error < 19.3714);
  EXPECT(policy->value + 3 * policy->standard_error > 10);
  EXPECT(work > 0);
}

TEST("The simple policy that is compared first has the time of all missions") {
  TigerSearch search;
  std::uint64_t usual = 0, all = 0;
  EXPECT(!search.best_policy(60, {1, never}, usual).has_value());
  EXPECT(search.best_policy(60, {1, never}, {0, never}, all).has_value());
  EXPECT(usual < all);
}

TEST("The simple policy that asks nothing has the time of all missions, too: it works, where others ask for what is of no use") {
  constexpr std::uint32_t phases = 5, work = 0, look = 1, left = 2, right = 3, sides = 2, end = 4 * (phases + 1);
  Problem problem = world(end + 1, 4, 0.99);
  problem.sensings = {{{0, 1.0}}, {{1, 1.0}}, {{2, 1.0}}, {{3, 0.8}, {4, 0.2}}, {{3, 0.2}, {4, 0.8}}};
  problem.endings[end] = 1;
  start_evenly(problem, 0, 4);
  for (std::uint32_t state = 0; state < end; ++state) {
    const std::uint32_t phase = state / 4, side = state / sides % 2, coin = state % 2;
    const auto tossed = [&](std::uint32_t next, std::uint32_t sensing, double reward) {
      return aos::List<exam::Outcome>{{0.5, 4 * next + 2 * side, sensing, reward}, {0.5, 4 * next + 2 * side + 1, sensing, reward}};
    };
    const bool is_last = phase == phases;
    for (const std::uint32_t action : {work, look, left, right}) row(problem, state, action) = {{1.0, end, 0, is_last && action == left + side ? 30.0 : -10.0}};
    if (is_last) continue;
    row(problem, state, work) = tossed(phase + 1, phase + 1 == phases ? 3 + side : 0, 0.0);
    row(problem, state, look) = tossed(phase, 1 + coin, -0.5);
  }
  const point_based::FlatModel model = flat_model(problem);
  point_based::OnlineSarsop search{model};
  search.move_to(model.starts.front().belief);
  std::uint64_t all = 0;
  const auto policy = search.best_policy(20, {1, never}, {0, never}, all);
  EXPECT(policy.has_value());
  EXPECT_NEAR(policy->value, std::pow(0.99, phases) * (0.8 * 30 - 0.2 * 10), 1e-6);
}

TEST("Bounds of actions hold before these are opened, and are narrower afterwards") {
  TigerSearch search;
  const double values[] = {19.3714, -45 + 0.95 * 19.3714};
  double gaps[] = {0, 0};
  for (const bool is_open : {false, true}) {
    if (is_open) search.open_actions(never);
    const auto actions = search.action_bounds();
    for (std::size_t action = 0; action < 2; ++action) {
      EXPECT(actions[action].lower <= values[action] && values[action] <= actions[action].upper);
      gaps[is_open] += actions[action].upper - actions[action].lower;
    }
  }
  EXPECT(gaps[true] < gaps[false]);
}

TEST("Twice as many states take a simple policy twice the work") {
  double work[] = {0, 0};
  for (const std::uint32_t states : {2000u, 4000u}) {
    // A look mostly tells whether the state's number is odd. To tell it, too, ends the mission.
    Problem problem = world(states + 1, 3, 0.9);
    start_evenly(problem, 0, states);
    problem.sensings = {{{0, 0.8}, {1, 0.2}}, {{0, 0.2}, {1, 0.8}}};
    problem.endings[states] = 1;
    for (std::uint32_t state = 0; state < states; ++state) {
      row(problem, state, 2) = {{1.0, state, state % 2, -1.0}};
      for (std::uint32_t told : {0u, 1u}) row(problem, state, told) = {{1.0, states, 0, told == state % 2 ? 10.0 : -10.0}};
    }
    const point_based::FlatModel model = flat_model(problem);
    point_based::OnlineSarsop search{model};
    search.move_to(model.starts.front().belief);
    std::uint64_t all = 0;
    EXPECT(search.best_policy(1, {0, never}, all).has_value());
    work[states > 2000] = static_cast<double>(all);
  }
  EXPECT(0 < work[0] && work[1] < 2.2 * work[0]);
}

TEST("A simple policy decides with a standard error above the bound, and with less if it decided last") {
  // A look for 4 tells whether to take 10, or to end for next to nothing. To take without it loses 100.
  int decided[] = {0, 0};
  int all = 0, narrow = 0;
  for (const double end : {-0.4, -0.2, 0.0, 0.1, 0.2, 0.3}) {
    Problem problem = world(3, 3, 0.9);
    problem.starts = {{0, 0.5}, {1, 0.5}};
    problem.sensings = {{{0, 1.0}}, {{1, 1.0}}};
    problem.endings[2] = 1;
    for (std::uint32_t state = 0; state < 2; ++state) {
      row(problem, state, 0) = {{1.0, state, state, -4.0}};
      row(problem, state, 1) = {{1.0, 2, 0, state == 0 ? 10.0 : -100.0}};
      row(problem, state, 2) = {{1.0, 2, 0, end}};
    }
    for (int odds = 40; odds < 60; odds += 2) {
      ++all;
      for (const bool has_decided : {false, true}) {
        point_based::OnlineSarsop search{flat_model(problem)};
        std::uint64_t work = 0;
        search.move_to({{0, 0.9}, {1, 0.1}});
        if (has_decided) EXPECT(search.best_policy(10, {0, never}, work).has_value());
        search.move_to({{0, 0.01 * odds}, {1, 1 - 0.01 * odds}});
        const auto policy = search.best_policy(10, {0, never}, work);
        if (!policy) continue;
        ++decided[has_decided];
        const double least = search.bounds().first;
        EXPECT(policy->value > least);
        if (policy->value - policy->standard_error > least) continue;
        ++narrow;
        EXPECT(has_decided);
      }
    }
  }
  EXPECT(narrow > 0);
  EXPECT(0 < decided[0] && decided[0] < decided[1] && decided[1] < all);
}

TEST("A simple policy that does what the plan of the lower bound does decides nothing") {
  for (const double cost : {0.07, 0.08, 0.3}) {  // of waiting for what nobody tells: to guess costs more
    Problem problem = world(3, 3, 0.97);
    start_evenly(problem, 0, 2);
    problem.endings[2] = 1;
    for (std::uint32_t state = 0; state < 2; ++state) {
      for (std::uint32_t guess = 0; guess < 2; ++guess) row(problem, state, guess) = {{1.0, 2, 0, guess == state ? 10.0 : -50.0}};
      row(problem, state, 2) = {{1.0, state, 0, -cost}};
    }
    point_based::OnlineSarsop search{flat_model(problem)};
    search.move_to({{0, 0.5}, {1, 0.5}});
    std::uint64_t work = 0;
    EXPECT(!search.best_policy(10, {0, never}, work).has_value());
    EXPECT(work > 0);
  }
}

TEST("Beside a room of too many states, a plan for the room behind it opens all boxes in turn") {
  constexpr std::uint32_t many = 400, boxes = 3, end = many + boxes;
  Problem problem = world(end + 1, boxes, 0.9);
  problem.sensings.push_back({{1, 1.0}});
  problem.endings[end] = 1;
  start_evenly(problem, 0, many);
  for (std::uint32_t action = 0; action < boxes; ++action) {
    for (std::uint32_t state = 0; state < many; ++state) row(problem, state, action) = {{1.0, many + state % boxes, 0, 0.0}};
    for (std::uint32_t box = 0; box < boxes; ++box) row(problem, many + box, action) = {{1.0, many + box, 0, -1.0}};
    row(problem, many + action, action) = {{1.0, end, 1, 10.0}};
  }
  point_based::OnlineSarsop search{flat_model(problem)};
  EXPECT(search.move_to({{many, 1.0 / 3}, {many + 1, 1.0 / 3}, {many + 2, 1.0 / 3}}));
  EXPECT_NEAR(search.bounds().first, (10 + (-1 + 0.9 * 10) + (-1 - 0.9 + 0.81 * 10)) / 3, 1e-6);
}

TEST("Where places are seen, the first bounds have a plan that goes to a far one") {
  constexpr std::uint32_t places = 5, stay = 0, go = 1, take = 2;
  for (const auto& [unseen, horizon] : {std::pair<std::uint32_t, std::size_t>{2, 10}, {400, 0}}) {  // of 400 no certainty-equivalent plan is made
    const std::uint32_t end = places * unseen;
    Problem problem = world(end + 1, 3, 0.9);
    start_evenly(problem, 0, unseen);
    problem.endings[end] = 1;
    problem.sensings.clear();
    for (std::uint32_t place = 0; place < places; ++place) problem.sensings.push_back({{static_cast<int>(place), 1.0}});
    for (std::uint32_t state = 0; state < end; ++state) {
      const std::uint32_t place = state / unseen, next = std::min(place + 1, places - 1);
      row(problem, state, stay) = {{1.0, state, place, -0.5}};
      row(problem, state, go) = {{1.0, next * unseen + state % unseen, next, -1.0}};
      row(problem, state, take) = {{1.0, end, 0, place < places - 1 ? -20.0 : state % 2 == 0 ? 10.0 : 20.0}};
    }
    point_based::FlatModel model = flat_model(problem);
    model.horizon = horizon;
    point_based::OnlineSarsop search{std::move(model)};
    EXPECT_NEAR(search.bounds().first, -1 - 0.9 - 0.81 - 0.729 + 0.6561 * 15, 1e-6);
  }
}

TEST("Where nothing is seen, a plan of the first bounds repeats one action") {
  constexpr std::uint32_t go = 0, take = 1, far = 1, end = 2;
  Problem problem = world(end + 1, 2, 0.9);
  start_evenly(problem, 0, end);
  problem.endings[end] = 1;
  row(problem, 0, go) = {{1.0, far, 0, 0.0}};
  row(problem, far, take) = {{1.0, end, 0, 10.0}};
  point_based::FlatModel model = flat_model(problem);
  model.horizon = 10;
  point_based::OnlineSarsop search{std::move(model)};
  EXPECT(search.move_to({{0, 0.5}, {far, 0.5}}));
  EXPECT_NEAR(search.bounds().first, 10 / 2.0, 1e-6);  // to go first, and then to take, would return 9
  search.improve(1'000'000, never);
  EXPECT_NEAR(search.bounds().first, 5 + 0.81 * 5, 1e-6);  // who goes on after a try is not there yet
}

TEST("A belief of states that no start leads to is refused") {
  Problem problem = world(4, 1, 0.9);
  problem.sensings = {{{0, 1.0}}, {{1, 1.0}}};
  problem.starts = {{0, 0.5}, {1, 0.5}};
  row(problem, 0, 0) = {{1.0, 2, 0, 1.0}};
  row(problem, 1, 0) = {{1.0, 3, 1, 2.0}};
  row(problem, 2, 0) = {{1.0, 2, 0, 1.0}};
  row(problem, 3, 0) = {{1.0, 3, 1, 2.0}};
  point_based::FlatModel model = flat_model(problem);
  const point_based::Regions regions{model};
  EXPECT_EQUAL(regions.region_of[0], regions.region_of[1]);
  point_based::OnlineSarsop search{std::move(model)};
  EXPECT(search.move_to({{0, 0.5}, {1, 0.5}}));
  EXPECT(!search.move_to({{0, 0.5}, {2, 0.5}}));
}

TEST("States that the robot always tells apart are in regions of their own, worthless ones in none") {
  Problem problem = world(3, 2, 0.9);
  problem.sensings = {{{0, 1.0}}, {{1, 1.0}}};
  row(problem, 0, 0) = {{0.5, 0, 0, 1.0}, {0.5, 1, 1, 1.0}};
  row(problem, 0, 1) = {{1.0, 2, 0, 0.0}};
  row(problem, 1, 0) = {{1.0, 0, 0, 3.0}};
  const point_based::FlatModel model = flat_model(problem);
  const point_based::Regions regions{model};
  EXPECT_EQUAL(regions.all.size(), 2u);
  int worthless = 0;
  for (std::uint32_t state = 0; state < 3; ++state) {
    worthless += regions.is_worthless(state);
    EXPECT_EQUAL(regions.is_worthless(state), regions.region_of[state] == point_based::nowhere);
  }
  EXPECT_EQUAL(worthless, 1);
}

TEST("Draws by columns have the weights that the columns were made of") {
  for (const aos::List<double>& weights : {aos::List<double>{1.0}, {1.0, 3.0}, {0.001, 0.5, 0.2, 7.0, 0.0001}}) {
    aos::List<aos::AliasColumns<int>::Weighted> outcomes;
    double total = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      outcomes.push_back({static_cast<int>(i), weights[i]});
      total += weights[i];
    }
    aos::List<aos::AliasColumn<int>> columns;
    aos::AliasColumns<int>{}.append(outcomes, total, columns);
    aos::Sampler random{11};
    std::map<int, int> counts;
    constexpr int draws = 100'000;
    const auto count = static_cast<std::uint32_t>(columns.size());
    for (int i = 0; i < draws; ++i) ++counts[aos::drawn(columns.data(), count, random.bits())];
    for (std::size_t i = 0; i < weights.size(); ++i) {
      EXPECT_NEAR(counts[static_cast<int>(i)] / double{draws}, weights[i] / total, 0.006);
    }
  }
}

}
