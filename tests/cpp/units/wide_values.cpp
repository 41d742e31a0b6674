// Numbers for states and the values of many of them: state_numbers.hpp, wide_values.hpp.
#include "aos/planning/values/wide_values.hpp"

#include "aos/planning/listed/state_numbers.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::wide_values_tests {

using Wide = aos::WideValues<TableModel>;

constexpr int horizon = 400;

// A problem with up to three outcomes of each of four actions, each step's reward between -5 and 5.
Problem drawn(std::uint64_t seed, std::size_t states) {
  aos::Sampler random{seed};
  Problem problem = world(states, 4, 0.9);
  problem.endings[states - 1] = 1;
  for (std::size_t state = 0; state < states; ++state) {
    for (std::size_t action = 0; action < 4; ++action) {
      auto& row = units::row(problem, state, action);
      row.clear();
      const int outcomes = 1 + random.below(3);
      for (int i = 0; i < outcomes; ++i) {
        const auto next = static_cast<std::uint32_t>(random.below(static_cast<int>(states)));
        row.push_back({1.0 / outcomes, next, 0, 10 * random.uniform() - 5});
      }
    }
  }
  return problem;
}

// The largest difference from value iteration, over the states that can be reached.
double largest_difference(const Problem& problem) {
  const Belief belief = initial_belief(problem);
  aos::StateSpace<TableModel> space;
  aos::MdpValues<TableModel> values{space};
  Wide wide;
  EXPECT(values.prepare(belief, horizon));
  EXPECT(wide.prepare(belief, horizon));
  EXPECT_EQUAL(wide.states(), space.size());
  double largest = 0;
  for (std::uint32_t number = 0; number < space.size(); ++number) {
    largest = std::max(largest, std::abs(wide.value(space[number], horizon) - values.value(number, horizon)));
  }
  return largest;
}

TEST("Values of many states are those of value iteration, in drawn problems") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) EXPECT_NEAR(largest_difference(drawn(seed, 30)), 0, 0.1);
}

TEST("Values of many states are those of value iteration, where the goal is far") {
  EXPECT_NEAR(largest_difference(corridor(40, 0.95)), 0, 0.001);
}

TEST("Of actions that lead to the same states the best one counts") {
  Problem problem = corridor(3, 0.9);
  row(problem, 2, 1) = row(problem, 2, 0);
  row(problem, 2, 1).front().reward = 12;
  EXPECT_NEAR(largest_difference(problem), 0, 0.001);
}

TEST("Of each action it is known what it is worth beyond its state") {
  const Problem problem = corridor(3, 0.9);
  const Belief belief = initial_belief(problem);
  Wide wide;
  aos::Sampler random{2};
  EXPECT(wide.prepare(belief, horizon));
  double worths[2] = {};
  wide.advantages(belief.particles().front().state, worths, random);
  EXPECT_NEAR(worths[0], 0, 0.001);
  EXPECT_NEAR(worths[1], (0.9 - 1) * 10 * 0.9 * 0.9, 0.001);
}

TEST("A state that was not listed has the highest value, also where all values are negative") {
  Problem problem = world(3, 1, 0.5);
  problem.endings[2] = 2;
  row(problem, 0, 0) = {{1.0, 1, 0, -1}};
  row(problem, 1, 0) = {{1.0, 2, 0, -8}};
  const Belief belief = initial_belief(problem);
  Wide wide;
  EXPECT(wide.prepare(belief, horizon));
  TableModel::State unknown = belief.particles().front().state;
  unknown.variables[1] = 7;
  EXPECT_NEAR(wide.value(unknown, horizon), -5, 1e-6);
}

TEST("Too many states have no values") {
  const Problem problem = corridor(40, 0.95);
  const Belief belief = initial_belief(problem);
  Wide wide{{.states = 39}};
  EXPECT(!wide.prepare(belief, horizon));
  EXPECT_EQUAL(wide.states(), 0u);
}

TEST("Values that do not settle within the horizon are not used") {
  const Problem problem = corridor(40, 0.95);
  const Belief belief = initial_belief(problem);
  Wide wide;
  EXPECT(!wide.prepare(belief, 1));
}

TEST("States keep their numbers when more variables turn out to differ") {
  const Problem problem = world(3, 1, 0.9);
  TableModel::take(problem);
  aos::StateNumbers<TableModel> numbers;
  const auto state_of = [](int first, int second) {
    TableModel::State state{};
    state.variables[0] = first;
    state.variables[1] = second;
    return state;
  };
  EXPECT_EQUAL(numbers.add(state_of(1, 5)), 0u);
  EXPECT_EQUAL(numbers.add(state_of(2, 5)), 1u);
  EXPECT_EQUAL(numbers.find(state_of(1, 6)), aos::no_state);
  EXPECT_EQUAL(numbers.add(state_of(1, 6)), 2u);
  EXPECT_EQUAL(numbers.add(state_of(2, 5)), 1u);
  EXPECT_EQUAL(numbers.find(state_of(1, 5)), 0u);
  EXPECT_EQUAL(numbers[0].variables[1], 5);
  EXPECT_EQUAL(numbers[1].variables[0], 2);
  EXPECT_EQUAL(numbers[2].variables[1], 6);
  EXPECT(numbers.are_same(numbers[1], state_of(2, 5)));
  EXPECT(!numbers.are_same(numbers[1], state_of(2, 6)));
}

}
