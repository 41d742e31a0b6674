// How far long work is: progress.hpp.
#include "aos/base/progress.hpp"

#include "aos/planning/planners.hpp"
#include "check.hpp"
#include "worlds.hpp"

namespace units::progress_tests {

aos::List<std::string> told;

void take(const char* what, std::uint64_t, std::uint64_t) { told.emplace_back(what); }

bool has_told(const char* what) { return std::find(told.begin(), told.end(), what) != told.end(); }

// Decides by SARSOP while somebody listens, who is told at every look.
std::uint64_t decided() {
  const Problem tiger = units::tiger();
  const Belief belief = initial_belief(tiger);
  aos::Sampler random{1};
  aos::Planners<TableModel> planner;
  planner.search(aos::PlannerKind::sarsop, belief, {.simulations = 10}, tiger.horizon, random);
  return random.bits();
}

TEST("A decision tells how far its lists and first bounds are") {
  told.clear();
  aos::progress::between = std::chrono::milliseconds{0};
  aos::progress::tell_to(take);
  const std::uint64_t told_bits = decided();
  aos::progress::tell_to(nullptr);
  aos::progress::between = std::chrono::milliseconds{250};
  EXPECT(has_told("listing states"));
  EXPECT(has_told("computing first bounds"));
  told.clear();
  EXPECT_EQUAL(decided(), told_bits);
  EXPECT(told.empty());
}

}
