// How far long work is, told to whoever waits for it. What is told depends on the clock; what is computed does not.
#pragma once

#include <chrono>
#include <cstdint>

namespace aos::progress {

using Clock = std::chrono::steady_clock;

// Takes what is being done, how much of it is done, and how much there is (0: nobody knows).
using Sink = void (*)(const char* what, std::uint64_t done, std::uint64_t all);

inline std::chrono::milliseconds between{250};

inline Sink sink = nullptr;
inline Clock::time_point next_look{};

// From now on, work of this thread is told to `to`; null tells nobody.
inline void tell_to(Sink to) {
  sink = to;
  next_look = Clock::now() + between;
}

// Tells how far the work is, four times a second at most. Loops call it every thousand turns or so.
inline void tell(const char* what, std::uint64_t done, std::uint64_t all = 0) {
  if (sink == nullptr) return;
  const auto now = Clock::now();
  if (now < next_look) return;
  next_look = now + between;
  sink(what, done, all);
}

}
