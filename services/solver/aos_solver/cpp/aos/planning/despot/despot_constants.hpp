// The constants by which DESPOT decides, each with its evidence; where none is named, nobody has varied it. What the
// operations cost that a budget counts stands where they are counted; docs/lab/budgets.md has measured it.
#pragma once

#include <cstddef>

namespace aos {

// --- scenarios

// Those of the paper (Ye, Somani, Hsu and Lee, 2017), and the fewest of a small budget.
inline constexpr std::size_t max_scenarios = 500;
inline constexpr std::size_t min_scenarios = 30;
// Of the budget, for a first look at all actions at the root.
inline constexpr double share_of_first_look = 0.2;

// --- the search

// Of its part of the root's gap, which a node may keep: that of the paper.
inline constexpr double gap_share = 0.95;
// What a decision has to be worth, in standard deviations of what the scenarios earn.
inline constexpr double penalty_in_deviations = 1;

// --- bounds

// Rollouts that guess the most that a scenario earns.
inline constexpr int rollouts_per_scenario = 3;
// Fewer scenarios than these have no action of their own that is best on average.
inline constexpr std::size_t smallest_group = 10;
// Of the scenarios with the same history, those that its bounds are taken of.
inline constexpr std::size_t max_evaluated = 50;

// --- work

// The engine for the smallest states copies so many bytes of each.
inline constexpr std::size_t least_copied_bytes = 64;

// --- limits

inline constexpr std::size_t max_scenario_bytes = std::size_t{512} << 20;
inline constexpr std::size_t max_node_bytes = std::size_t{128} << 20;

}
