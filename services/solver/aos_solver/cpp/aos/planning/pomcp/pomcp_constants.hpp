// The constants by which POMCP decides, each with its evidence; where none is named, nobody has varied it. What the operations
// cost that a budget counts stands where they are counted; docs/lab/budgets.md has measured it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos {

// --- exploration

// Visits with a spread that was seen elsewhere, which fill up an action's own.
inline constexpr double prior_visits = 4;
// Of the exploration where rollouts value new histories, independent of the rollout policy: docs/lab/pocman.md.
inline constexpr double even_share = 0.1;
inline constexpr double usual_share = 0.9;  // an even share, less a margin for rounding
// One simulation of so many begins with the root's actions in turn. Without that a family of random models loses 11.6 %
// (docs/lab/ablation.md).
inline constexpr std::uint64_t turns = 8;
// Simulations between two looks at the root's spread.
inline constexpr std::uint64_t spread_renewal = 256;

// --- the value of a history

// Visits of a history before its best action gives its value.
inline constexpr std::uint32_t settled_visits = 16;
// An action counts with one of so many of the most visited action's visits. Without exceptions it is too many: docs/lab/untuned.md.
inline constexpr std::uint32_t well_visited_share = 4;
// Rollouts that tell what the search has gained over them, a hundredth of the budget between these.
inline constexpr std::uint64_t fewest_rollouts = 10;
inline constexpr std::uint64_t most_rollouts = 100;

// --- what is known before

// States of a history that tell what its actions are worth. Twelve were worse in ship10: docs/lab/learned-values.md.
inline constexpr std::uint32_t asked_states = 8;
// Steps of the model that make a prior of the root's actions.
inline constexpr std::size_t max_prior_steps = 20'000;

// --- rewards and observations

// Steps of a simulation whose rewards count by their expectation: docs/lab/untuned.md. Nobody has varied the number of paths.
inline constexpr std::size_t expected_steps = 2;
inline constexpr int max_reward_paths = 32;  // of a step
// Cells of reported numbers after n visits of an action: `cells_of_one_visit` n^`cell_widening`.
inline constexpr double cells_of_one_visit = 4;
inline constexpr double cell_widening = 0.05;
inline constexpr std::size_t max_observation_cells = 4'000'000;

// Of the loss for each nat of entropy: the prices of a nat that are tried, and the price that a search pays of what is lost by the
// best of them (docs/lab/information.md). Missions by each, the states
// that their robot knows, and steps of the model for all of them.
inline constexpr double priced_shares[] = {0.2, 0.5};
inline constexpr double price_of_rest = 0.5;
inline constexpr std::size_t priced_missions = 24;
inline constexpr std::size_t priced_particles = 48;
inline constexpr std::size_t most_priced_steps = 15'000'000;

// --- limits

inline constexpr std::size_t max_search_bytes = std::size_t{1} << 30;  // of the trees of all threads
// Of a budget in time, always used, so that a first look does not decide.
inline constexpr double min_time_share = 0.1;

}
