// Values of states that are learned from simulations: learned_values.hpp.
#include "aos/planning/values/learned_values.hpp"

#include "check.hpp"
#include "worlds.hpp"

namespace units::learned_values_tests {

constexpr int horizon = 60;

// Values of a problem that are learned from its first belief.
struct Learned {
  explicit Learned(const Problem& problem, int decisions = horizon, std::uint64_t seed = 1)
      : random{seed}, belief{taken(problem, random)}, is_usable{values.prepare(belief, decisions, random)} {}

  static Belief taken(const Problem& problem, aos::Sampler& random) {
    TableModel::take(problem);
    return Belief::initial(random);
  }
  const TableModel::State& start() const { return belief.particles().front().state; }

  aos::Sampler random;
  Belief belief;
  aos::LearnedValues<TableModel> values;
  bool is_usable;  // after the values, which it asks
};

TEST("Values are learned behind an exit that is open everywhere") {
  const Problem problem = corridor_with_exits(40, 3);
  Learned learned{problem};
  EXPECT(learned.is_usable);
  EXPECT_NEAR(learned.values.value(learned.start(), horizon), 10, 0.5);
  double worths[4] = {};
  learned.values.advantages(learned.start(), worths, learned.random);
  EXPECT_NEAR(worths[0], -10, 0.5);
  EXPECT_NEAR(worths[3], 0, 0.5);
}

// Six lamps, of which each action switches one on: it earns 1 where it was off. The state's number has a bit each.
Problem lamps(double discount) {
  constexpr std::uint32_t states = 64;
  Problem problem = world(states, 6, discount);
  for (std::uint32_t state = 0; state < states; ++state) {
    for (std::uint32_t lamp = 0; lamp < 6; ++lamp) {
      const bool is_on = state >> lamp & 1;
      row(problem, state, lamp) = {{1.0, state | 1u << lamp, 0, is_on ? 0.0 : 1.0}};
    }
  }
  return problem;
}

TEST("Values of a corridor are the discounted way to its prize, and 0 without decisions to go") {
  const Problem problem = corridor(40, 0.95);
  Learned learned{problem};
  EXPECT(learned.is_usable);
  TableModel::State state = learned.start();
  for (int cell = 0; cell < 40; ++cell) {
    EXPECT_NEAR(learned.values.value(state, horizon), 10 * std::pow(0.95, 39 - cell), 0.5);
    EXPECT_EQUAL(learned.values.value(state, 0), 0.0);
    TableModel::step(state, 0, learned.random);
  }
  EXPECT(state.ending == aos::Ending::goal);
}

TEST("An action is worth its reward and what the next state is worth, and nothing where it ends") {
  const Problem problem = corridor(40, 0.95);
  Learned learned{problem};
  TableModel::State state = learned.start();
  for (int cell = 0; cell < 38; ++cell) TableModel::step(state, 0, learned.random);
  TableModel::State next = state;
  TableModel::step(next, 0, learned.random);
  const double later = 0.95 * learned.values.value(next, horizon - 1);
  EXPECT_NEAR(learned.values.stepped_value(state, 0, horizon, learned.random), later, 1e-12);
  EXPECT_EQUAL(learned.values.stepped_value(state, 0, 1, learned.random), 0.0);
  EXPECT_EQUAL(learned.values.stepped_value(next, 0, horizon, learned.random), 10.0);
}

TEST("The same seed learns the same values") {
  const Problem problem = lamps(0.9);
  const Learned first{problem, 12, 7};
  const Learned again{problem, 12, 7};
  EXPECT_EQUAL(first.values.value(first.start(), 12), again.values.value(again.start(), 12));
  EXPECT(first.values.value(first.start(), 12) > 1);
}

TEST("Values are no use where rollouts earn as much: the best action is the one that earns most at once") {
  Problem problem = world(8, 2, 0.1);
  for (std::uint32_t state = 0; state < 8; ++state) {
    for (std::uint32_t action = 0; action < 2; ++action) {
      auto& row = units::row(problem, state, action);
      row.clear();
      for (std::uint32_t next = 0; next < 8; ++next) row.push_back({1.0 / 8, next, 0, 1.0 * action});
    }
  }
  const Learned learned{problem, 12};
  EXPECT(!learned.is_usable);
  EXPECT_NEAR(learned.values.value(learned.start(), 12), 1 / (1 - 0.1), 0.05);
}

TEST("Nothing is learned of a belief that has ended, and once of any other") {
  const Problem problem = corridor(1, 0.95);
  TableModel::take(problem);
  aos::Sampler random{1};
  const Belief initial = Belief::initial(random);
  aos::LearnedValues<TableModel> values;
  EXPECT(!values.prepare(initial.predicted(0, random), horizon, random));
  const bool is_usable = values.prepare(initial, horizon, random);
  aos::Sampler before = random;
  EXPECT_EQUAL(values.prepare(initial, horizon, random), is_usable);
  EXPECT_EQUAL(random.bits(), before.bits());
}

}
