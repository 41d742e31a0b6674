// How fast three problems can be stepped and searched by code written for them alone, on one thread: the bound that the
// generated code is measured against. Usage: baseline PROBLEM SECONDS SEED. One line of JSON for each figure; rates are
// per second of processor time.
#include <ctime>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "navigation.hpp"
#include "pomcp.hpp"
#include "problem.hpp"
#include "random.hpp"
#include "rocksample.hpp"
#include "tiger.hpp"

namespace bench {
namespace {

constexpr std::uint32_t simulations_of_a_search = 65'536;

double cpu_seconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void say(const char* problem, const char* metric, double value, double check) {
  std::printf("{\"problem\": \"%s\", \"metric\": \"%s\", \"value\": %.6g, \"check\": %.6g}\n", problem, metric, value,
              check);
}

// Steps with random actions; a new start at the end or at the search's depth, as the engine's `rate` does it. The check
// is the mean reward.
template <class Problem>
void measure_steps(double seconds, std::uint64_t seed) {
  Random random{seed};
  auto state = Problem::start(random);
  double rewards = 0, spent = 0;
  std::uint64_t steps = 0;
  int depth = 0;
  const double start = cpu_seconds();
  do {
    for (int i = 0; i < 65'536; ++i, ++steps) {
      const Outcome outcome = Problem::step(state, static_cast<int>(random.below(Problem::action_count)), random);
      rewards += outcome.reward;
      if (++depth == Problem::depth || outcome.ends) {
        state = Problem::start(random);
        depth = 0;
      }
    }
    spent = cpu_seconds() - start;
  } while (spent < seconds);
  say(Problem::name, "steps", static_cast<double>(steps) / spent, rewards / static_cast<double>(steps));
}

// Searches of the same size one after the other. The check is how many steps a simulation has.
template <class Problem, PlayOut play_out>
void measure_search(const char* metric, double seconds, std::uint64_t seed) {
  Random random{seed};
  Pomcp<Problem, play_out> search{simulations_of_a_search};
  search.search(simulations_of_a_search, random);  // so that the pages are there
  const std::uint64_t steps_before = search.steps();
  double spent = 0;
  std::uint64_t simulations = 0;
  const double start = cpu_seconds();
  do {
    search.search(simulations_of_a_search, random);
    simulations += simulations_of_a_search;
    spent = cpu_seconds() - start;
  } while (spent < seconds);
  const auto steps = static_cast<double>(search.steps() - steps_before);
  say(Problem::name, metric, static_cast<double>(simulations) / spent, steps / static_cast<double>(simulations));
}

template <class Problem>
void measure(double seconds, std::uint64_t seed) {
  measure_steps<Problem>(seconds, seed);
  if constexpr (Problem::has_knowledge) {
    measure_search<Problem, PlayOut::promising>("simulations", seconds, seed);
    measure_search<Problem, PlayOut::legal>("simulations, uniform", seconds, seed);
  } else {
    measure_search<Problem, PlayOut::legal>("simulations", seconds, seed);
  }
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  const std::string_view problem = argc == 4 ? argv[1] : "";
  const auto measured = problem == Tiger::name        ? measure<Tiger>
                        : problem == RockSample::name ? measure<RockSample>
                        : problem == Navigation::name ? measure<Navigation>
                                                      : nullptr;
  if (!measured) {
    std::fprintf(stderr, "usage: %s %s|%s|%s SECONDS SEED\n", argv[0], Tiger::name, RockSample::name, Navigation::name);
    return 2;
  }
  measured(std::atof(argv[2]), std::strtoull(argv[3], nullptr, 10));
}
