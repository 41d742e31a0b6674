// The constants by which SARSOP decides, each with its evidence; where none is named, nobody has varied it. What the
// operations cost that a budget counts stands where they are counted; docs/lab/budgets.md has measured it.
#pragma once

#include <cstddef>

namespace aos::point_based {

// --- the budget of a decision

// Of the budget: missions that tell the value, and of these missions by simple policies that decide anew. Trials have 0.5 at
// least, and policies what is left, which cost 36 in lightdark where they decided nothing (docs/lab/simple-policies.md).
inline constexpr double share_of_missions = 0.2;
inline constexpr double share_of_anew = 0.05;
inline constexpr double share_of_trials = 0.5;

// --- the horizon

// What a discount may leave of a value beyond the horizon of a search that has none: much, where there are many decisions or
// observations. Where the line is drawn hardly matters: docs/lab/horizons.md.
inline constexpr double much = 0.5;
inline constexpr double next_to_nothing = 0.01;
inline constexpr double max_likelihoods_in_layers = 2e6;  // times decisions

// --- trials

// A trial aims below this share of the root's gap.
inline constexpr double share_of_gap = 0.1;
inline constexpr std::size_t longest_trial = 1000;
// Of the first trials, which repeat one action.
inline constexpr std::size_t longest_detour = 30;

// --- the end of a search

// A gap of this share of the value matters to no decision.
inline constexpr double closed_share = 1e-5;
// A gap of this share is small enough to ask what missions lose of the value, and for no policy to be tried.
inline constexpr double nearly_closed_share = 0.05;

// --- simple policies

// Missions that tell a mean, those by each policy at first, and those by the last one that is left.
inline constexpr std::size_t fewest_missions = 4;
inline constexpr std::size_t first_missions = 8;
inline constexpr std::size_t most_missions = 64;
// Up to so many observations of an action the probabilities of each are kept by state: sums over them are fast.
inline constexpr std::size_t few_branches = 8;

// --- limits

inline constexpr std::size_t max_graph_bytes = std::size_t{512} << 20;  // of beliefs, before those are forgotten

}
