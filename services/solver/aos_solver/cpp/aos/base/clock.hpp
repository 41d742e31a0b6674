// The clock of planning budgets. It counts real time, or the processor time of this process. Processor time
// is the fairer measure of a planner on a machine that has other work.
#pragma once

#include <chrono>
#include <ctime>

namespace aos {

inline std::chrono::nanoseconds processor_time() {
  std::timespec spent{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return std::chrono::seconds{spent.tv_sec} + std::chrono::nanoseconds{spent.tv_nsec};
}

// The processor time of the calling thread. It is finer than that of the process, which a running interval timer makes
// coarse.
inline std::chrono::nanoseconds thread_time() {
  std::timespec spent{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return std::chrono::seconds{spent.tv_sec} + std::chrono::nanoseconds{spent.tv_nsec};
}

// A clock in the sense of the standard library. Time points of the two kinds must not be mixed.
struct PlanningClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<PlanningClock>;
  static constexpr bool is_steady = true;

  inline static bool counts_processor_time = false;

  static time_point now() {
    if (counts_processor_time) return time_point{processor_time()};
    return time_point{std::chrono::duration_cast<duration>(std::chrono::steady_clock::now().time_since_epoch())};
  }
};

inline double seconds_since(PlanningClock::time_point start) { return std::chrono::duration<double>(PlanningClock::now() - start).count(); }

}
