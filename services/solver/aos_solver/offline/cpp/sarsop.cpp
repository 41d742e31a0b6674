// The offline solver. It reads a flat model, writes alpha vectors, and prints its progress as lines of JSON.
//
// The solver ends when the bounds are as near as asked for, when its time or memory is used up, when trials find
// nothing more, or when anything comes on standard input or that is closed. It then writes the best vectors so far.
#include <poll.h>

#include <cstdio>
#include <exception>

#include "aos/base/clock.hpp"
#include "aos/text/json.hpp"
#include "point_based/flat_file.hpp"
#include "point_based/flat_model.hpp"
#include "point_based/regions.hpp"
#include "point_based/sarsop.hpp"
#include "policy_file.hpp"

namespace {

using namespace aos::offline;
using namespace aos::point_based;

constexpr int crossed_status = 3;

// The processor time of this process, so that a busy machine changes nothing.
double cpu_seconds() { return std::chrono::duration<double>(aos::processor_time()).count(); }

bool is_told_to_stop() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0;
}

void report(Sarsop& solver, const char* ending) {
  const auto [lower, upper] = checked(solver.lower(), solver.upper());
  aos::JsonWriter json;
  json.begin_object().member("seconds", cpu_seconds());
  json.member("lower", lower).member("upper", upper);
  json.member("vectors", solver.vectors()).member("beliefs", solver.graph().size()).member("backups", solver.backups());
  json.member("ending", ending).end_object();
  std::puts(json.text().c_str());
  std::fflush(stdout);
}

// What ends the search, also in the middle of a trial: one trial of a large model may take minutes.
class Limits {
 public:
  Limits(const Sarsop& solver, double seconds, std::size_t memory_bytes)
      : solver_(solver), seconds_(seconds), memory_bytes_(memory_bytes) {}

  // Why the search is over; empty as long as it is not.
  const char* ending() {
    if (*ending_ != '\0') return ending_;
    const double now = cpu_seconds();
    if (now >= seconds_) {
      ending_ = "time";
    } else if (solver_.graph().bytes() >= memory_bytes_) {
      ending_ = "memory";
    } else if (is_told_to_stop()) {
      ending_ = "stopped";
    }
    if (*ending_ != '\0') late_from_ = now + std::min(grace * now, most_grace_s);
    return ending_;
  }
  bool is_over() { return *ending() != '\0'; }
  // Whether what was found out can no longer be put to use.
  bool is_late() const { return *ending_ != '\0' && cpu_seconds() >= late_from_; }

 private:
  static constexpr double grace = 0.1;  // of the time used up, for the backups of the last trial
  static constexpr double most_grace_s = 5;

  const Sarsop& solver_;
  double seconds_;
  std::size_t memory_bytes_;
  const char* ending_ = "";
  double late_from_ = 0;
};

const char* improve(Sarsop& solver, double precision, Limits& limits) {
  double next_line = 0;
  const auto is_over = [&] { return limits.is_over(); };
  const auto is_late = [&] { return limits.is_late(); };
  for (;;) {
    if (const double now = cpu_seconds(); now >= next_line) {
      report(solver, "");
      // Lines come often at first, when most happens.
      next_line = now + std::clamp(0.25 * now, 0.005, 2.0);
    }
    if (solver.upper() - solver.lower() <= precision) return "precision";
    if (limits.is_over()) return limits.ending();
    if (!solver.improve(precision, is_over, is_late)) return limits.is_over() ? limits.ending() : "settled";
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: %s MODEL POLICY_DESCRIPTOR PRECISION CPU_SECONDS MEMORY_BYTES\n", argv[0]);
    return 2;
  }
  try {
    const FlatModel model = read_flat_model(argv[1]);
    const Regions regions{model};
    Sarsop solver{model, regions};
    Limits limits{solver, std::atof(argv[4]), std::strtoull(argv[5], nullptr, 10)};
    const char* ending = improve(solver, std::atof(argv[3]), limits);
    solver.prune([&] { return limits.is_late(); });
    write_policy(std::atoi(argv[2]), regions, solver);
    report(solver, ending);
  } catch (const CrossedBounds& crossed) {
    std::fprintf(stderr, "%s\n", crossed.what());
    return crossed_status;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
