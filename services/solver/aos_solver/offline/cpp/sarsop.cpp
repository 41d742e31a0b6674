// The offline solver. It reads a flat model, writes alpha vectors, and prints its progress as lines of JSON.
//
// The solver ends when the bounds are as near as asked for, when its time or memory is used up, when trials find
// nothing more, or when anything comes on standard input or that is closed. It then writes the best vectors so far.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "aos/base/clock.hpp"
#include "aos/base/json.hpp"
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

const char* improve(Sarsop& solver, double precision, double seconds, std::size_t memory_bytes) {
  double next_line = 0;
  const auto never = [] { return false; };
  for (;;) {
    if (const double now = cpu_seconds(); now >= next_line) {
      report(solver, "");
      // Lines come often at first, when most happens.
      next_line = now + std::clamp(0.25 * now, 0.005, 2.0);
    }
    if (solver.upper() - solver.lower() <= precision) return "precision";
    if (cpu_seconds() >= seconds) return "time";
    if (solver.graph().bytes() >= memory_bytes) return "memory";
    if (is_told_to_stop()) return "stopped";
    if (!solver.improve(precision, never, never)) return "settled";
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
    const char* ending = improve(solver, std::atof(argv[3]), std::atof(argv[4]), std::strtoull(argv[5], nullptr, 10));
    solver.prune();
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
