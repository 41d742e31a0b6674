// What a budget in simulations buys in each planner: budget.hpp. Work is counted here, and no clock is asked.
#include "aos/planning/planners.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace units::budgets_tests {

using aos::PlannerKind;

constexpr int horizon = 10;
constexpr std::uint64_t simulations = 2000;

// The steps that a planner takes of a prepared search.
double steps_of(aos::Planner<TableModel>& planner, const Belief& belief) {
  const aos::BarredActions none;
  const aos::Question<TableModel> question{belief, {.simulations = simulations}, horizon, none};
  aos::Sampler random{1};
  aos::Choosing choosing;
  planner.prepare(question, random, choosing);
  TableModel::noisy_steps = TableModel::noisy_steps_with_texts = 0;
  planner.search(question, random, choosing.why);
  return static_cast<double>(TableModel::noisy_steps);
}

TEST("POMCP and DESPOT take as many steps of a model that cannot be listed, up to a factor of three, and remember no texts") {
  Problem tiger = units::tiger();
  tiger.noise = exam::Noise::refused;
  const Belief belief = drawn_belief(tiger);
  aos::StateSpace<TableModel> space;
  aos::MdpValues<TableModel> values{space};
  aos::GroupMissions<TableModel> missions;
  aos::Pomcp<TableModel> pomcp{space, values, missions};
  aos::Despot<TableModel> despot{space, values, missions};
  const double of_pomcp = steps_of(pomcp, belief);
  EXPECT_EQUAL(TableModel::noisy_steps_with_texts, 0u);
  const double of_despot = steps_of(despot, belief);
  EXPECT(of_pomcp < 3 * of_despot);
  EXPECT_EQUAL(TableModel::noisy_steps_with_texts, 0u);
  EXPECT(of_despot < 3 * of_pomcp);
}

TEST("A budget that is over before the search begins still tries some action") {
  Problem tiger = units::tiger();
  tiger.noise = exam::Noise::refused;
  const Belief belief = drawn_belief(tiger);
  for (const PlannerKind kind : {PlannerKind::pomcp, PlannerKind::automatic}) {
    aos::Planners<TableModel> planners;
    aos::Sampler random{1};
    EXPECT(planners.search(kind, belief, {.seconds = 1e-9}, horizon, random) > 0);
    const aos::Estimates estimates = planners.estimates(belief);
    EXPECT(estimates[planners.choice(estimates)].n > 0);
  }
}

TEST("A tenth of a budget in time is left for the planner that decides, however long others have looked") {
  constexpr aos::Budget budget{.simulations = 7, .seconds = 2, .threads = 3};
  EXPECT_NEAR(budget.left_after(0.5).seconds, 1.5, 1e-12);
  for (const double spent : {1.9, 2.0, 60.0}) EXPECT_NEAR(budget.left_after(spent).seconds, 0.2, 1e-12);
  EXPECT_EQUAL(budget.left_after(60).simulations, 7u);
  EXPECT_EQUAL(budget.left_after(60).threads, 3);
  EXPECT_EQUAL(aos::Budget{.simulations = 7}.left_after(60).seconds, 0.0);
}

TEST("A robot that can act in hundreds of ways does not seek where to look round takes more steps than it has") {
  constexpr double steps = 20'000;
  Problem problem = world(160, 400, 0.95);
  start_evenly(problem, 0, 160);
  problem.noise = exam::Noise::refused;
  const Belief belief = drawn_belief(problem);
  aos::Sampler random{1};
  aos::SeekPolicy<TableModel> policy;
  policy.find(belief, horizon, {}, 10, random);  // what runs down is found out once
  TableModel::noisy_steps = 0;
  EXPECT_EQUAL(policy.find(belief, horizon, {}, steps, random).action, -1);
  EXPECT(TableModel::noisy_steps <= steps);
}

TEST("No planner takes much more than its budget in simulations, and POMCP takes all of it") {
  const Problem problem = corridor_with_exits(30, 3);
  const Belief belief = initial_belief(problem);
  for (const PlannerKind kind : {PlannerKind::pomcp, PlannerKind::despot, PlannerKind::sarsop, PlannerKind::automatic}) {
    aos::Planners<TableModel> planner;
    aos::Sampler own{1};
    const std::uint64_t taken = planner.search(kind, belief, {.simulations = simulations}, horizon, own);
    EXPECT(taken <= simulations * 11 / 10);
    if (kind == PlannerKind::pomcp) EXPECT(taken >= simulations);
  }
}

// Searches from the start of a corridor, one after the other.
struct Corridor {
  Problem problem;
  aos::Sampler random{1};
  Belief belief;
  aos::Planners<TableModel> planner;

  Corridor(int length, int exits) : problem(corridor_with_exits(length, exits)), belief(initial_belief(problem)) {}

  std::uint64_t search(PlannerKind kind, std::uint64_t count) {
    return planner.search(kind, belief, {.simulations = count}, horizon, random);
  }
};

TEST("A search by SARSOP that has nothing left to search says where its bounds come from") {
  Corridor corridor{3, 1};
  corridor.search(PlannerKind::sarsop, 100'000);
  EXPECT_EQUAL(corridor.search(PlannerKind::sarsop, 100'000), 0u);
  EXPECT(corridor.planner.why().find("nothing was searched now") != std::string::npos);
}

TEST("A draw from weights that code computes counts as more than a flag, and more for more weights") {
  aos::CountedDraws draws{1};
  const auto cost = [&](auto&& draw) {
    const double before = draws.cost();
    draw();
    return draws.cost() - before;
  };
  const aos::List<double> weights(20, 0.05);
  const double of_flag = cost([&] { draws.flag(0.5); });
  const double of_three = cost([&] { draws.choose(weights.data(), 3, 0.15); });
  const double of_twenty = cost([&] { draws.choose(weights.data(), 20, 1.0); });
  EXPECT(0 < of_flag && of_flag < of_three && of_three < of_twenty);
  EXPECT_EQUAL(cost([&] { draws.flag(1.0); }), 0.0);
}

TEST("A search by POMCP that ends all at once still comes to an end") {
  Corridor corridor{1, 1};
  EXPECT_EQUAL(corridor.search(PlannerKind::pomcp, 50), 50u);
}

}
