// What a planner may spend on a decision, and what it says about each action.
#pragma once

#include <cstdint>

namespace aos {

inline constexpr std::uint32_t no_node = 0xffffffffu;
inline constexpr int most_search_threads = 32;

struct Budget {
  std::uint64_t simulations = 0;  // 0: no limit
  double seconds = 0;             // 0: no limit
  int threads = 1;                // 1 to `most_search_threads`
};

// An action's value, from how many simulations (0: unknown), and the standard error of their mean.
struct ActionEstimate {
  double q = 0;
  std::uint32_t n = 0;
  double standard_error = 0;
};

}  // namespace aos
