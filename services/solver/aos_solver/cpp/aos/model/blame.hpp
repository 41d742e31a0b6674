// Notes which piece of document code runs, so that a crash or a hang can be told to its author.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos::blame {

#ifdef __x86_64__
inline constexpr std::size_t page_bytes = 4096;
#else
inline constexpr std::size_t page_bytes = 65536;  // the largest page that Linux has anywhere
#endif
inline constexpr std::size_t line_words = 64 / sizeof(std::uint32_t);  // a cache line, so that threads do not wait
inline constexpr int max_threads = 64;

// Each thread has two numbers at the start of its line: the piece that runs, and how often document code came
// to an end. The engine child maps memory that outlives the process over this page. The page has a fixed
// address: a pointer to it could point to anything that a step reads, and steps would be slower.
alignas(page_bytes) inline volatile std::uint32_t page[page_bytes / sizeof(std::uint32_t)];

inline thread_local std::size_t place = 0;

// Threads 1 to `max_threads` - 1 call this before they run document code. The first thread has line 0.
inline void use_line(int thread) { place = static_cast<std::size_t>(thread) * line_words; }

// Notes the piece that runs. Pieces count from 1 in the order of the emitted file; 0 is the engine's own code.
inline void at(std::uint32_t piece) { page[place] = piece; }

// Notes that document code came to an end. Code that begins afterwards may never end: see watchdog.hpp.
inline void over() {
  page[place] = 0;
  page[place + 1] = page[place + 1] + 1;
}

// Traced code says that it can tell in which state it is, and is asked for that where it does not come to an end.
inline volatile bool tells_state = false;
inline volatile bool is_state_wanted = false;

// How often document code of this thread came to an end.
inline std::uint32_t ends() { return page[place + 1]; }

// The piece that runs in this thread.
inline std::uint32_t piece() { return page[place]; }

}
