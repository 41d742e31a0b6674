// The constants by which states are valued, each with its evidence; where none is named, nobody has varied it. What the
// operations cost that a budget counts stands where they are counted; docs/lab/budgets.md has measured it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos {

// --- values that are computed

inline constexpr std::size_t max_layered_values = 8'000'000;  // of listed states, one for each number of decisions to go
// Of values of many states, before a list begins: walks, their work in steps and copies of 64 bytes, and states whose steps
// tell what the list will cost.
inline constexpr std::size_t looked_at = 20'000;
inline constexpr std::size_t max_looking_work = 600'000;
inline constexpr std::size_t priced_states = 100;

// --- values that are learned

// Steps of a round, and rounds. The second effort is made where the first one fails its test: with it and with walks that put off
// their end, a search for victims returned 13.3 in place of 1.9 (docs/lab/learned-values.md).
struct LearningEffort {
  std::size_t successors;
  int rounds;
};
inline constexpr LearningEffort learning_efforts[] = {{100'000, 2}, {200'000, 3}};
inline constexpr int learning_sweeps = 30;
inline constexpr int attempts_to_go_on = 8;  // of a walk that would end, at each step
// Actions that a policy compares at each step, at most.
inline constexpr int max_compared_actions = 24;
// Missions of the test, and what those of rollouts may take: rollouts before a decision, and steps in all. It keeps learned values
// in ship10 and maint10, and drops them in PocMan and RockSample(15, 15): docs/lab/learned-values.md.
inline constexpr int tested_missions = 64;
inline constexpr double min_compared_missions = 4;
inline constexpr double sure_errors = 4;  // with two, values pass by luck that cost PocMan a quarter
inline constexpr int max_tested_rollouts = 32;
inline constexpr std::size_t max_tested_steps = 2'000'000;
// Limits of memory.
inline constexpr std::size_t max_example_bytes = std::size_t{32} << 20;  // of the states of a round
inline constexpr std::size_t max_example_cells = 20'000'000;             // of all rows

// --- tables over few variables

// Cells of a variable, where its values are many or real.
inline constexpr double max_cell_values = 255;
inline constexpr std::size_t max_cell_ranges = 24;
// Variables of a table. Four gained nothing: docs/lab/learned-values.md.
inline constexpr int max_table_order = 3;
inline constexpr std::size_t max_cell_tables = 24;
inline constexpr std::uint32_t max_table_cells = 1 << 16;
// Variables up to which all pairs are tried, and look-ups of a search for a new table.
inline constexpr std::uint32_t max_paired_variables = 40;
inline constexpr std::size_t max_tried_lookups = 6'000'000;
// What a new table has to explain: of the targets' squares, and for each of its cells, in variances of what is left.
inline constexpr double max_unexplained_share = 2e-4;
inline constexpr double variances_of_chance = 3;

// --- missions that tell a value

// Of a budget, at each decision, and as much for all of them at the first one.
inline constexpr double share_of_groups = 0.01;
// States of a group: at least, at most, and of one after the first.
inline constexpr double fewest_followers = 30;
inline constexpr double most_followers = 500;
inline constexpr double fewest_later_followers = 100;
// States with rarer observations stay together. About so many of a group choose its action.
inline constexpr std::size_t fewest_alike = 10;
inline constexpr std::size_t asked_followers = 16;

}
