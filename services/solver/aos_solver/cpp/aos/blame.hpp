// Which piece of document code runs now, so that a crash or a hang can be told to its author.
#pragma once

#include <cstdint>

namespace aos::blame {

inline std::uint32_t unshared = 0;

// Where the number goes; the engine child points it into a page that outlives the process.
inline volatile std::uint32_t* page = &unshared;

// Pieces count from 1 in the order of the emitted file; 0 is code of ours.
inline void at(std::uint32_t piece) { *page = piece; }

}  // namespace aos::blame
