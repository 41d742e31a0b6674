// What is somewhere is sought: seek_planner.hpp, seek_policy.hpp.
#include "aos/planning/seek/seek_planner.hpp"

#include "aos/planning/listed/state_space.hpp"
#include "aos/planning/pomcp/pomcp.hpp"
#include "aos/planning/values/group_missions.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::seek_tests {

constexpr std::uint32_t cells = 14;
constexpr int go = 0, back = 1, look = 2, take = 3, leave = 4;
constexpr int horizon = 60;

// A thing is in one of the far cells of a corridor. To look tells whether it is near, often, and to leave pays for it in the first cell only.
Problem corridor_with_a_thing(double found) {
  const std::uint32_t things = cells + 1;  // the last number: the robot has it
  const std::uint32_t states = cells * things;
  Problem problem = world(states + 2, 5, 0.98);
  problem.noise = exam::Noise::drawn;  // as of a battery
  problem.endings[states] = 1;
  problem.endings[states + 1] = 2;
  problem.horizon = horizon;
  problem.sensings.push_back({{0, 0.85}, {1, 0.15}});
  problem.sensings.push_back({{0, 0.05}, {1, 0.95}});
  problem.sensings.push_back({{0, 1.0}});
  problem.sensings.push_back({{1, 1.0}});
  start_evenly(problem, 4, cells);
  for (std::uint32_t state = 0; state < states; ++state) {
    const std::uint32_t cell = state / things, thing = state % things;
    problem.values[2 * state] = static_cast<int>(cell);
    problem.values[2 * state + 1] = static_cast<int>(thing);
    const bool is_near = thing != cells && cell + 1 >= thing && cell <= thing + 1;
    const std::uint32_t next = cell + 1 < cells ? cell + 1 : cell, last = cell > 0 ? cell - 1 : cell;
    row(problem, state, go) = {{1.0, next * things + thing, 0, -0.2}};
    row(problem, state, back) = {{1.0, last * things + thing, 0, -0.2}};
    row(problem, state, look) = {{1.0, state, is_near ? 1u : 2u, -0.2}};
    row(problem, state, take) = {{1.0, thing == cell ? cell * things + cells : state, thing == cell ? 3u : 4u, thing == cell ? -0.2 : -3.0}};
    const bool is_paid = thing == cells;
    row(problem, state, leave) = {{1.0, cell == 0 ? states : states + 1, 0, cell > 0 ? -60 : is_paid ? found : 0}};
  }
  return problem;
}

// What seek finds at the first cell, and whether it is ready to decide there.
struct Found {
  aos::Sought sought;
  double returned_at_once;
  bool is_ready;
  std::string why;
  std::string decided_by;

  explicit Found(const Problem& problem) {
    const auto belief = drawn_belief(problem);
    aos::Sampler random{2};
    const aos::BarredActions none;
    aos::SeekPolicy<TableModel> policy;
    sought = policy.find(belief, horizon, none, 100'000, random);
    returned_at_once = policy.returned_at_once();
    aos::StateSpace<TableModel> space;
    aos::MdpValues<TableModel> values{space};
    aos::GroupMissions<TableModel> missions;
    aos::Pomcp<TableModel> pomcp{space, values, missions};
    aos::Choosing choosing;
    aos::SeekPlanner<TableModel> planner{space, pomcp};
    const aos::Question<TableModel> question{belief, {.simulations = 500}, horizon, none};
    is_ready = planner.prepare(question, random, choosing);
    if (is_ready) planner.search(question, random, why);
    decided_by = planner.name();
  }
};

TEST("Who seeks a thing that is somewhere goes towards where it may be, and that returns more than to leave at once") {
  const Problem problem = corridor_with_a_thing(60);
  const Found found{problem};
  EXPECT_EQUAL(found.sought.action, go);
  EXPECT_EQUAL(found.returned_at_once, 0);
  EXPECT(found.sought.returned > 20);
  EXPECT(found.sought.error < 3);
  EXPECT(found.is_ready);
  EXPECT_EQUAL(found.decided_by, found.why.ends_with("and decides") ? "seek" : "pomcp");
}

TEST("A thing that pays less than the way to it is not sought") {
  const Problem problem = corridor_with_a_thing(1);
  const Found found{problem};
  EXPECT_EQUAL(found.sought.action, -1);
  EXPECT(!found.is_ready);
}

TEST("States that differ by what runs down alone are one state of a belief, with their weights") {
  const Problem problem = corridor_with_a_thing(60);
  const auto belief = drawn_belief(problem);
  aos::Sampler random{2};
  aos::SampledBelief<TableModel> sampled;
  sampled.draw_alike(belief, 64, [](const TableModel::State& state) { return static_cast<std::uint64_t>(state.variables[1] % 2); }, random);
  EXPECT_EQUAL(sampled.size(), std::size_t{2});
  EXPECT_NEAR(sampled.weights()[0], 0.5, 0.05);
  sampled.draw_alike(belief, 4, [](const TableModel::State& state) { return static_cast<std::uint64_t>(state.variables[1]); }, random);
  EXPECT_EQUAL(sampled.size(), std::size_t{4});
}

TEST("Where nothing is left to be sought, it is known what the best end at once returns") {
  Problem problem = corridor_with_a_thing(60);
  problem.starts = {{2 * (cells + 1) + cells, 1.0}};  // in the third cell, with the thing
  const auto belief = drawn_belief(problem);
  aos::Sampler random{2};
  aos::SeekPolicy<TableModel> policy;
  EXPECT_EQUAL(policy.find(belief, horizon, aos::BarredActions{}, 100'000, random).action, -1);
  EXPECT_NEAR(policy.returned_at_once(), 60 * 0.98 * 0.98 - 0.2 - 0.2 * 0.98, 1e-9);
}

}
