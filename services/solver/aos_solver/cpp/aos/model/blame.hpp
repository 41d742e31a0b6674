// Which piece of document code runs now, so that a crash or a hang can be told to its author.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aos::blame {

#ifdef __x86_64__
inline constexpr std::size_t page_bytes = 4096;
#else
inline constexpr std::size_t page_bytes = 65536;  // the largest page that Linux has anywhere
#endif
inline constexpr std::size_t line_words = 64 / sizeof(std::uint32_t);  // a cache line, so that no thread waits
inline constexpr int max_threads = 64;

// Two numbers for each thread, at the start of its line: what runs, and how often it came to an end. The engine child lays
// a page that outlives the process over this one. Its place is fixed, since a pointer to it could point to anything that a
// step looks at.
alignas(page_bytes) inline volatile std::uint32_t page[page_bytes / sizeof(std::uint32_t)];

inline thread_local std::size_t place = 0;

// A thread of number 1 to `max_threads` - 1 calls this before it runs document code; the first has line 0.
inline void use_line(int thread) { place = static_cast<std::size_t>(thread) * line_words; }

// Pieces count from 1 in the order of the emitted file; 0 is code of ours.
inline void at(std::uint32_t piece) { page[place] = piece; }

// Document code came to an end: what began to run since then may be one that does not. See watchdog.hpp.
inline void over() {
  page[place] = 0;
  page[place + 1] = page[place + 1] + 1;
}

// What runs in this thread.
inline std::uint32_t piece() { return page[place]; }

}  // namespace aos::blame
