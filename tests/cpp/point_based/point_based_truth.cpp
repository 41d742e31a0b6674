// Whether the point-based solver's bounds hold, on random models, and how near its plans come to the best.
// Usage: point_based_truth FIRST_SEED MODELS WORK. Each decision gets so much work (`OnlineSarsop::improve`).
//
// A line of JSON for every claim that does not hold, and one at the end.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "point_based/online.hpp"
#include "random_models.hpp"
#include "reference.hpp"

namespace truth {
namespace {

using aos::point_based::ActionBounds;
using aos::point_based::OnlineSarsop;

constexpr std::size_t listed_beliefs = 600;

double cpu_seconds() {
  std::timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Tally {
  std::uint64_t claims = 0;
  std::uint64_t false_claims = 0;
  std::uint64_t judged = 0;  // plans whose regret is known to a thousandth of the range
  double regrets = 0;
  double worst_regret = 0;
  double gaps = 0;
  double worst_gap = 0;
  std::uint64_t worst_seed = 0;
  std::uint64_t decisions = 0;
  double decision_s = 0;  // of processor time
  double longest_decision_s = 0;
};

class Trial {
 public:
  Trial(std::uint64_t seed, std::uint64_t work, Tally& tally)
      : seed_(seed), work_(work), tally_(tally), generator_(seed), problem_(generator_.problem()),
        reference_(problem_.model) {}

  // Decides some times, as a mission does, and judges what is claimed of each belief.
  void run() {
    OnlineSarsop solver{problem_.model};
    Belief belief;
    for (const auto& [state, probability] : problem_.model.starts.front().belief) belief.emplace_back(state, probability);
    for (step_ = 0; step_ < 3 && !belief.empty(); ++step_) {
      aos::List<std::pair<std::uint32_t, double>> entries;
      for (const auto& [state, probability] : belief) entries.emplace_back(state, static_cast<double>(probability));
      for (std::size_t i = 0; i < belief.size(); ++i) belief[i].second = entries[i].second;
      Real total = 0;
      for (const auto& [state, probability] : belief) total += probability;
      for (auto& [state, probability] : belief) probability /= total;
      if (!solver.move_to(entries)) return claim(false, "is a belief that the start leads to", 0, 0, 0);
      truth_ = reference_.action_values(belief, listed_beliefs);
      solver.improve(1, [] { return false; });
      judge(solver);
      const double begun = cpu_seconds();
      solver.improve(work_, [] { return false; });
      count_decision(cpu_seconds() - begun);
      judge(solver);
      if (step_ == 0) judge_plan(solver, belief);
      belief = next_of(belief);
    }
  }

 private:
  Interval best() const {
    Interval best = truth_.front();
    for (const Interval& value : truth_) {
      best.lower = std::max(best.lower, value.lower);
      best.upper = std::max(best.upper, value.upper);
    }
    return best;
  }

  void count_decision(double seconds) {
    ++tally_.decisions;
    tally_.decision_s += seconds;
    tally_.longest_decision_s = std::max(tally_.longest_decision_s, seconds);
  }

  void judge(OnlineSarsop& solver) {
    const auto [lower, upper] = solver.bounds();
    const Interval value = best();
    claim(lower <= upper, "lower above upper", lower, upper, upper);
    claim(lower <= value.upper + reference_.tolerance(), "lower bound", lower, value.lower, value.upper);
    claim(upper >= value.lower - reference_.tolerance(), "upper bound", upper, value.lower, value.upper);
    const aos::List<ActionBounds> bounds = solver.action_bounds();
    for (std::size_t action = 0; action < bounds.size(); ++action) {
      const Interval of_action = truth_[action];
      claim(bounds[action].lower <= of_action.upper + reference_.tolerance(), "lower bound of an action",
            bounds[action].lower, of_action.lower, of_action.upper);
      claim(bounds[action].upper >= of_action.lower - reference_.tolerance(), "upper bound of an action",
            bounds[action].upper, of_action.lower, of_action.upper);
    }
  }

  // How much less than the best what is sure of the plan gives, in parts of what is between chance and the best.
  void judge_plan(OnlineSarsop& solver, const Belief& belief) {
    const Interval value = best();
    const Real range = value.upper - reference_.random_value(belief);
    const auto [lower, upper] = solver.bounds();
    if (range <= 1e-9L * (std::abs(value.upper) + std::abs(value.lower)) + 1e-12L) return;
    if (value.upper - value.lower > 1e-3L * range) return;
    ++tally_.judged;
    const auto regret = static_cast<double>((value.upper - lower) / range);
    tally_.regrets += regret;
    if (regret > tally_.worst_regret) {
      tally_.worst_regret = regret;
      tally_.worst_seed = seed_;
    }
    const auto gap = static_cast<double>((upper - lower) / range);
    tally_.gaps += gap;
    tally_.worst_gap = std::max(tally_.worst_gap, gap);
  }

  void claim(bool holds, const char* what, Real claimed, Real lower, Real upper) {
    ++tally_.claims;
    if (holds) return;
    ++tally_.false_claims;
    std::printf("{\"false\": \"%s\", \"seed\": %llu, \"kind\": \"%s\", \"step\": %d, \"discount\": %g, \"horizon\": %zu, "
                "\"states\": %zu, \"claimed\": %.17Lg, \"truth\": [%.17Lg, %.17Lg]}\n",
                what, static_cast<unsigned long long>(seed_), problem_.kind.c_str(), step_, problem_.model.discount,
                problem_.model.horizon, problem_.model.states, claimed, lower, upper);
  }

  // After an action and an observation by chance.
  Belief next_of(const Belief& belief) {
    const auto by_observation = reference_.successors(belief, generator_.below(problem_.model.actions));
    double chosen = generator_.uniform();
    for (const auto& [observation, weights] : by_observation) {
      Real total = 0;
      for (const auto& [state, weight] : weights) total += weight;
      if ((chosen -= static_cast<double>(total)) > 0) continue;
      Belief next;
      for (const auto& [state, weight] : weights) next.emplace_back(state, weight / total);
      return next;
    }
    return {};
  }

  std::uint64_t seed_;
  std::uint64_t work_;
  Tally& tally_;
  Generator generator_;
  Problem problem_;
  Reference reference_;
  aos::List<Interval> truth_;
  int step_ = 0;
};

int run(std::uint64_t first_seed, std::uint64_t models, std::uint64_t work) {
  Tally tally;
  for (std::uint64_t seed = first_seed; seed < first_seed + models; ++seed) {
    try {
      Trial{seed, work, tally}.run();
    } catch (const std::exception& error) {
      ++tally.false_claims;
      std::printf("{\"false\": \"%s\", \"seed\": %llu}\n", error.what(), static_cast<unsigned long long>(seed));
    }
  }
  const double judged = std::max<double>(1, static_cast<double>(tally.judged));
  std::printf("{\"models\": %llu, \"claims\": %llu, \"false_claims\": %llu, \"judged\": %llu, \"mean_regret\": %.6g, "
              "\"worst_regret\": %.6g, \"worst_seed\": %llu, \"mean_gap\": %.6g, \"worst_gap\": %.6g, "
              "\"mean_decision_s\": %.6f, \"longest_decision_s\": %.6f, \"cpu_s\": %.3f}\n",
              static_cast<unsigned long long>(models), static_cast<unsigned long long>(tally.claims),
              static_cast<unsigned long long>(tally.false_claims), static_cast<unsigned long long>(tally.judged),
              tally.regrets / judged, tally.worst_regret, static_cast<unsigned long long>(tally.worst_seed),
              tally.gaps / judged, tally.worst_gap,
              tally.decision_s / std::max<double>(1, static_cast<double>(tally.decisions)), tally.longest_decision_s,
              cpu_seconds());
  return tally.false_claims == 0 ? 0 : 1;
}

}  // namespace
}  // namespace truth

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s FIRST_SEED MODELS WORK\n", argv[0]);
    return 2;
  }
  return truth::run(std::strtoull(argv[1], nullptr, 10), std::strtoull(argv[2], nullptr, 10),
                    std::strtoull(argv[3], nullptr, 10));
}
