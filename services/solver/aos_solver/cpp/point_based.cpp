// Point-based search for the engine; compiled once for all models, whatever the size of their states.
#include "point_based/online.hpp"

#include <algorithm>
#include <cmath>

#include "point_based/regions.hpp"
#include "point_based/sarsop.hpp"

namespace aos::point_based {

namespace {

constexpr double closed_share = 1e-4;  // of the largest reward: a gap that no decision depends on
constexpr std::size_t most_bytes = std::size_t{512} << 20;

double largest_reward(const FlatModel& model) {
  double largest = 0;
  for (const double reward : model.rewards) largest = std::max(largest, std::abs(reward));
  return largest;
}

}  // namespace

struct OnlineSarsop::Solver {
  explicit Solver(FlatModel flat)
      : model(std::move(flat)), regions(model), sarsop(model, regions), precision(closed_share * largest_reward(model)) {}

  // All states that are worth anything in one region.
  bool is_in_one_region(const std::vector<std::pair<std::uint32_t, double>>& belief) const {
    std::uint32_t region = nowhere;
    for (const auto& [state, probability] : belief) {
      if (regions.is_worthless(state)) continue;
      if (regions.region_of[state] == nowhere || (region != nowhere && regions.region_of[state] != region)) return false;
      region = regions.region_of[state];
    }
    return true;
  }

  // `trial` returns how many states it has backed up.
  template <class Trial>
  std::uint64_t repeat(std::uint64_t most_states, const IsOver& is_over, Trial&& trial) const {
    std::uint64_t states = 0;
    do {
      const std::uint64_t more = trial();
      if (more == 0) break;
      states += more;
    } while ((most_states == 0 || states < most_states) && !is_over());
    return states;
  }

  FlatModel model;
  Regions regions;
  Sarsop sarsop;
  double precision;
};

OnlineSarsop::OnlineSarsop(FlatModel model) : solver_(std::make_unique<Solver>(std::move(model))) {}
OnlineSarsop::~OnlineSarsop() = default;

void OnlineSarsop::start_over() { solver_->sarsop.start_over(); }

bool OnlineSarsop::move_to(const std::vector<std::pair<std::uint32_t, double>>& belief) {
  if (!solver_->is_in_one_region(belief)) return false;
  solver_->sarsop.move_to({1, belief}, most_bytes);
  return true;
}

std::uint64_t OnlineSarsop::improve(std::uint64_t most_states, const IsOver& is_over) {
  Sarsop& sarsop = solver_->sarsop;
  return solver_->repeat(most_states, is_over, [&]() -> std::uint64_t {
    const bool is_closed = sarsop.upper() - sarsop.lower() <= solver_->precision;
    return is_closed ? 0 : sarsop.improve(solver_->precision, is_over);
  });
}

std::uint64_t OnlineSarsop::improve_below(std::uint32_t action, std::uint64_t most_states, const IsOver& is_over) {
  return solver_->repeat(most_states, is_over,
                         [&] { return solver_->sarsop.improve_below(action, solver_->precision, is_over); });
}

std::vector<ActionBounds> OnlineSarsop::action_bounds() { return solver_->sarsop.action_bounds(); }
std::pair<double, double> OnlineSarsop::bounds() { return {solver_->sarsop.lower(), solver_->sarsop.upper()}; }

}  // namespace aos::point_based
