// Responses that are too many to list: sensing_tables.hpp, belief_tree.hpp.
#include "aos/planning/belief_tree/belief_tree.hpp"

#include "aos/draws/described_distribution.hpp"
#include "aos/draws/distributions.hpp"
#include "aos/model/transition.hpp"
#include "aos/planning/belief_tree/sensing_tables.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::belief_tree_tests {

// After action 0 a text of eight letters is observed: each is an `a` with three quarters in even states and a quarter
// in odd ones.
struct Whispering : TableModel {
  // Whether each letter has a draw, one draw decides them all, or the text is one word from thousands.
  enum class Noise { own, joint, whole };
  inline static Noise noise = Noise::own;

  template <class Random>
  static aos::Step step(State& state, int action, Random& random) {
    const aos::Step step = TableModel::step(state, action, random);
    if (state.ending != aos::Ending::running || action != 0) return step;
    aos::EffectWithText effect;
    const aos::ShownText shown{effect};
    effect.text.clear();
    constexpr int letters = 8;
    const double odds = state.variables[0] % 2 == 0 ? 0.75 : 0.25;
    const double first = random.sensing().SampleUniform(0, 1);
    if (noise == Noise::whole) {
      for (double rest = first; effect.text.size() < letters; rest = 26 * rest - std::floor(26 * rest)) {
        effect.text += static_cast<char>('a' + static_cast<int>(26 * rest));
      }
    }
    for (int i = 0; noise != Noise::whole && i < letters; ++i) {
      const double drawn = random.sensing().SampleUniform(0, 1);
      effect.text += (noise == Noise::joint ? first : drawn) < odds ? 'a' : 'b';
    }
    return {step.reward, aos::text_observation(effect.text)};
  }
};
using Belief = aos::Belief<Whispering>;
using Space = aos::StateSpace<Whispering>;

Belief initial_belief(const Problem& problem) {
  Whispering::noise = Whispering::Noise::own;
  return units::initial_belief<Whispering>(problem);
}

// Two sides that nothing changes. Action 0 listens for 1, action 1 waits. Actions 2 and 3 end the mission: they earn 10
// on their side, and lose 100 on the other.
Problem doors() {
  Problem problem = world(3, 4, 0.95);
  problem.starts = {{0, 0.5}, {1, 0.5}};
  problem.endings[2] = 1;
  for (std::uint32_t side = 0; side < 2; ++side) {
    row(problem, side, 0) = {{1.0, side, 0, -1}};
    for (std::uint32_t door = 0; door < 2; ++door) {
      row(problem, side, door + 2) = {{1.0, 2, 0, door == side ? 10.0 : -100.0}};
    }
  }
  return problem;
}

// The logarithms to base 3 of how much likelier texts are in the one state than in the other.
aos::List<double> evidence(const Belief& belief) {
  Space space;
  EXPECT(space.reach(belief));
  EXPECT(space.leaves_out_observations());
  aos::SensingTables<Whispering> tables{space};
  tables.prepare();
  const std::size_t row[] = {space.rows().row(0, 0), space.rows().row(1, 0)};
  std::uint32_t table[2];
  for (int again = 0; again < 2; ++again) {
    for (int side = 0; side < 2; ++side) table[side] = tables.table(row[side], space.rows().outcomes.first[row[side]]);
  }
  aos::Sampler random{3};
  aos::TabledObservation seen;
  aos::List<double> result;
  for (int i = 0; i < 4'000; ++i) {
    tables.draw(table[0], random, seen);
    const double likelihood = tables.likelihood(table[0], seen);
    EXPECT(likelihood > 0);
    result.push_back(std::log(likelihood / tables.likelihood(table[1], seen)) / std::log(3.0));
  }
  return result;
}

TEST("The probability of a text is that of its pieces") {
  const Problem problem = doors();
  double sum = 0;
  const auto all = evidence(initial_belief(problem));
  for (const double each : all) {
    EXPECT_NEAR(each, 2 * std::round(each / 2), 1e-5);  // so many more letters of the one kind, of 8
    sum += each;
  }
  EXPECT_NEAR(std::abs(sum / static_cast<double>(all.size())), 8 * 0.5, 0.2);
}

TEST("Pieces that one draw decides are no more evidence than one of them") {
  const Problem problem = doors();
  const Belief belief = initial_belief(problem);
  Whispering::noise = Whispering::Noise::joint;
  for (const double each : evidence(belief)) EXPECT_NEAR(std::abs(each), 1.0, 1e-5);
}

TEST("A described distribution has the densities of the one that it describes, and draws by its quantiles") {
  const double weights[] = {0.2, 0.5, 0.3};
  const aos::Normal normal{2, 0.5};
  const aos::Uniform uniform{3, 1};
  const aos::Discrete discrete{weights};
  for (const aos::Distribution* each : {static_cast<const aos::Distribution*>(&normal),
                                        static_cast<const aos::Distribution*>(&uniform),
                                        static_cast<const aos::Distribution*>(&discrete)}) {
    const aos::DescribedDistribution described = each->described();
    for (const double value : {0.0, 1.0, 1.25, 2.0}) {
      if (each == &discrete && value == 1.25) continue;
      EXPECT_NEAR(std::exp(described.log_density(value)), std::exp(each->log_density(value)), 1e-12);
    }
    for (const double place : {0.1, 0.4, 0.9}) {
      const double value = described.quantile(place);
      EXPECT(described.below(value) <= place + 1e-12);
      EXPECT(described.below(value + 1e-9) >= place - 1e-8);
    }
  }
}

struct Tree {
  explicit Tree(const Belief& belief, int horizon) { obstacle = tree.prepare(belief, horizon); }
  aos::List<aos::ActionEstimate> searched(const Belief& belief, int horizon, std::uint64_t simulations) {
    aos::Sampler random{7};
    tree.search_from_root({.simulations = simulations}, horizon, random, {});
    return tree.estimates(belief);
  }
  Space space;
  aos::MdpValues<Whispering> values{space};
  aos::GroupMissions<Whispering> missions;
  aos::BeliefTree<Whispering> tree{space, values, missions};
  std::string obstacle;
};

TEST("A search of beliefs pays for what it would observe, and decides by it") {
  const Problem problem = doors();
  Belief belief = initial_belief(problem);
  Tree tree{belief, 6};
  EXPECT_EQUAL(tree.obstacle, "");
  // Were all seen after one action, waiting would be worth 9.5 and listening 8.5.
  const auto unsure = tree.searched(belief, 6, 3'000);
  EXPECT(unsure[0].q > unsure[1].q);
  EXPECT_NEAR(unsure[0].q, 7.2, 1.0);
  EXPECT_NEAR(unsure[2].q, -45.0, 1e-3);
  EXPECT(unsure[0].n > unsure[1].n);

  Problem known = problem;
  known.starts = {{1, 1.0}};
  Belief sure = initial_belief(known);
  EXPECT_EQUAL(tree.tree.prepare(sure, 6), "");
  const auto decided = tree.searched(sure, 6, 300);
  EXPECT_NEAR(decided[3].q, 10.0, 1e-3);
  for (const std::size_t other : {0, 1, 2}) EXPECT(decided[3].q > decided[other].q);
}

TEST("An action that tells nothing and changes nothing is not worth what is earned by what is observed") {
  const Problem problem = doors();
  const Belief belief = initial_belief(problem);
  Tree tree{belief, 12};
  // Waiting costs nothing, so that after it all would be seen for nothing.
  for (const std::uint64_t simulations : {30, 100, 300, 1000}) {
    const auto values = tree.searched(belief, 12, simulations);
    EXPECT(values[1].q <= 0.95 * std::max(values[0].q, values[1].q) + 1e-3);
    EXPECT(values[0].q > values[1].q);
  }
}

TEST("With one decision to go a search of beliefs has the exact values at once") {
  const Problem problem = doors();
  const Belief belief = initial_belief(problem);
  Tree tree{belief, 1};
  const auto values = tree.searched(belief, 1, 10);
  EXPECT_NEAR(values[0].q, -1.0, 1e-6);
  EXPECT_NEAR(values[1].q, 0.0, 1e-6);
  EXPECT_NEAR(values[2].q, -45.0, 1e-5);
}

TEST("The same budget in simulations gives the same values to the last bit, also with tables that are there") {
  const Problem problem = doors();
  const Belief belief = initial_belief(problem);
  Tree one{belief, 6};
  Tree other{belief, 6};
  const auto values = one.searched(belief, 6, 500);
  const auto again = one.searched(belief, 6, 500);
  const auto elsewhere = other.searched(belief, 6, 500);
  for (std::size_t a = 0; a < values.size(); ++a) {
    EXPECT_EQUAL(values[a].q, again[a].q);
    EXPECT_EQUAL(values[a].q, elsewhere[a].q);
    EXPECT_EQUAL(values[a].n, elsewhere[a].n);
  }
}

TEST("Responses that hardly ever come twice are refused") {
  const Problem problem = doors();
  const Belief belief = initial_belief(problem);
  Whispering::noise = Whispering::Noise::whole;
  Tree tree{belief, 6};
  EXPECT_EQUAL(tree.obstacle, "hardly a response comes twice");
}

}
