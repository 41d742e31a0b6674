// Ends a process whose document code does not come to an end, so that its author is told soon.
//
// The watchdog counts processor time, so a busy machine blames nobody. The blame page tells it, and later the
// parent, which code runs.
#pragma once

#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>

#include "aos/model/blame.hpp"

namespace aos::watchdog {

inline constexpr int exit_status = 71;  // known to engine_child.py
inline constexpr long period_us = 100'000;

namespace detail {

inline int max_periods = 0;  // of processor time, for each thread that runs document code

struct Seen {
  std::uint32_t ends = 0;
  int periods = 0;
};

// The signal handler. It is async-signal-safe: it reads and writes memory, and may end the process.
inline void look(int) {
  static std::array<Seen, blame::max_threads> seen;
  int running = 0;
  for (std::size_t thread = 0; thread < seen.size(); ++thread) running += blame::page[thread * blame::line_words] != 0;
  for (std::size_t thread = 0; thread < seen.size(); ++thread) {
    const std::uint32_t ends = blame::page[thread * blame::line_words + 1];
    const bool goes_on = blame::page[thread * blame::line_words] != 0 && ends == seen[thread].ends;
    seen[thread] = {ends, goes_on ? seen[thread].periods + 1 : 0};
    if (!goes_on || seen[thread].periods < max_periods * running) continue;
    if (blame::tells_state && !blame::is_state_wanted) {
      blame::is_state_wanted = true;  // Its next statement ends it. Code without one has as much time again.
      seen[thread].periods = 0;
      continue;
    }
    for (std::size_t other = 0; other < seen.size(); ++other) {
      if (other != thread) blame::page[other * blame::line_words] = 0;
    }
    ::_exit(exit_status);
  }
}

}  // namespace detail

// Lets SIGVTALRM end the process once it has spent so much more processor time; 0 takes that back. engine_child.py knows
// the signal.
inline void allow(double seconds) {
  const auto whole = static_cast<long>(seconds);
  const itimerval once{{0, 0}, {whole, static_cast<long>((seconds - static_cast<double>(whole)) * 1e6)}};
  ::setitimer(ITIMER_VIRTUAL, &once, nullptr);
}

// From now on, `look` runs after each `period_us` of processor time. Document code may run for `max_periods` of these.
inline void start(int max_periods) {
  detail::max_periods = max_periods;
  struct sigaction action{};
  action.sa_handler = detail::look;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGPROF, &action, nullptr);
  const itimerval period{{0, period_us}, {0, period_us}};
  ::setitimer(ITIMER_PROF, &period, nullptr);
}

}  // namespace aos::watchdog
