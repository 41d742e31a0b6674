// The constants by which trees of beliefs decide, each with its evidence; where none is named, nobody has varied it. What the
// operations cost that a budget counts stands where they are counted; docs/lab/budgets.md has measured it. The exploration is
// that of POMCP: 0.3 of it and twice as much gained nothing (docs/lab/lasertag.md).
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos {

// --- the tree

// Beliefs after n visits of an action: `beliefs_of_one_visit` n^`belief_widening`.
inline constexpr double beliefs_of_one_visit = 4;
inline constexpr double belief_widening = 0.3;
// States of a belief in a tree, and of the root, drawn anew for each belief after it.
inline constexpr std::size_t tree_states = 100;
inline constexpr std::size_t tree_root_states = 500;

// --- probabilities of observations

// Runs of the model's code along an outcome.
inline constexpr std::size_t sensing_runs = 64;
// The first runs, which tell tables apart.
inline constexpr std::size_t compared_runs = 8;
// Runs and draws by which sensors' draws are told from those that shape the next state.
inline constexpr std::size_t tested_runs = 4;
inline constexpr std::size_t max_tested_draws = 64;
// The highest logarithm of a ratio of densities, so that no weight is infinite.
inline constexpr double highest_log_ratio = 60;
// Of what is observed, the share that no run gave, above which POMCP decides.
inline constexpr double max_unknown_share = 0.5;

// --- limits

inline constexpr std::size_t max_belief_tree_bytes = std::size_t{256} << 20;
inline constexpr std::uint64_t max_prepared_runs = 1'000'000;  // steps of the model before a search
inline constexpr std::size_t max_sensing_tables = 500'000;

}
