// Point-based search for the engine; compiled once for all models, whatever the size of their states.
#include "aos/base/switches.hpp"
#include "point_based/constants.hpp"
#include "point_based/online.hpp"

#include <random>

#include "point_based/outlook.hpp"
#include "point_based/regions.hpp"
#include "point_based/sarsop.hpp"

namespace aos::point_based {

namespace {

constexpr double share_of_bits = 0x1p-64;
constexpr std::uint64_t between_looks = 20'000;  // at the clock, in operations

}  // namespace

struct OnlineSarsop::Solver {
  explicit Solver(FlatModel flat)
      : horizon(flat.horizon), model(std::move(flat)), outlook(model), regions(model), sarsop(model, regions) {}

  // Whether all states that are worth anything are in one region.
  bool is_in_one_region(const List<std::pair<std::uint32_t, double>>& belief) const {
    std::uint32_t region = nowhere;
    for (const auto& [state, probability] : belief) {
      if (regions.is_worthless(state)) continue;
      if (regions.region_of[state] == nowhere || (region != nowhere && regions.region_of[state] != region)) return false;
      region = regions.region_of[state];
    }
    return true;
  }

  // The gap at which the search ends. A discount nearer to 1 makes delays cheaper, so the gap has to be smaller.
  double precision() const {
    const double size = std::max(std::abs(sarsop.lower()), std::abs(sarsop.upper()));
    return std::max(closed_share * std::min(1.0, 20 * (1 - model.discount)) * size, sarsop.graph().noise());
  }
  double gap() const { return sarsop.upper() - sarsop.lower(); }
  bool is_closed() const { return gap() <= precision(); }
  // Whether the bounds tell the value well enough to ask what missions lose of it.
  bool is_nearly_closed() const { return is_closed() || gap() <= nearly_closed_gap(); }
  double nearly_closed_gap() const {
    return nearly_closed_share * std::max(std::abs(sarsop.lower()), std::abs(sarsop.upper()));
  }

  double above() const { return outlook.above(sarsop.graph().min_value()); }
  double below() const { return outlook.below(sarsop.graph().max_value()); }

  // `trial(is_enough)` returns whether there is more to find out. `is_enough` also cuts a trial short.
  std::uint64_t repeat(std::uint64_t max_work, const IsOver& is_over, auto&& trial) {
    const std::uint64_t before = sarsop.graph().work();
    const auto is_enough = [&] { return (max_work > 0 && sarsop.graph().work() - before >= max_work) || is_over(); };
    while (trial(is_enough) && !is_enough()) {}
    return sarsop.graph().work() - before;
  }

  // Asks a clock now and then: it takes long beside an action of a simple policy.
  auto seldom(const IsOver& is_over) {
    return [this, &is_over, looked = sarsop.graph().work(), is_late = is_over()]() mutable {
      if (is_late || sarsop.graph().work() - looked < between_looks) return is_late;
      looked = sarsop.graph().work();
      return is_late = is_over();
    };
  }

  // Calls `play(ends, uniform)` with the end of the work or of the time, and with luck that is always the same. Adds the work.
  auto played(std::uint64_t max_work, Asked is_over, std::uint64_t& work, auto&& play) {
    const std::uint64_t before = sarsop.graph().work();
    std::mt19937_64 bits{1};
    const auto ends = [&] { return is_over() || (max_work > 0 && sarsop.graph().work() - before >= max_work); };
    const auto found = play(ends, [&] { return static_cast<double>(bits()) * share_of_bits; });
    work += sarsop.graph().work() - before;
    return found;
  }

  const std::size_t horizon;  // that was asked for
  FlatModel model;
  Outlook outlook;
  Regions regions;
  Sarsop sarsop;
};

OnlineSarsop::OnlineSarsop(FlatModel model) : solver_(std::make_unique<Solver>(std::move(model))) {}
OnlineSarsop::~OnlineSarsop() = default;

void OnlineSarsop::start_over() { solver_->sarsop.start_over(); }

bool OnlineSarsop::move_to(const List<std::pair<std::uint32_t, double>>& belief) { return move_to(belief, solver_->horizon); }

bool OnlineSarsop::move_to(const List<std::pair<std::uint32_t, double>>& belief, std::size_t left) {
  const std::size_t layers = solver_->model.horizon;
  if (left != solver_->horizon && left > layers) return false;
  if (!solver_->is_in_one_region(belief)) return false;
  solver_->sarsop.move_to({1, belief}, std::min(left, layers), max_graph_bytes);
  return true;
}

std::uint64_t OnlineSarsop::improve(std::uint64_t max_work, const IsOver& is_over, const IsOver& is_late) {
  return solver_->repeat(max_work, is_over, [&](const auto& is_enough) {
    return !solver_->is_closed() && solver_->sarsop.improve(solver_->precision(), is_enough, is_late);
  });
}

std::uint64_t OnlineSarsop::improve_below(std::uint32_t action, const IsOver& is_over) {
  return solver_->repeat(0, is_over,
                         [&](const auto& is_enough) { return solver_->sarsop.improve_below(action, solver_->precision(), is_enough, is_over); });
}

List<MissionLoss> OnlineSarsop::losses(std::uint32_t action, std::size_t steps, std::uint64_t max_work,
                                              const IsOver& is_over, std::uint64_t& work) {
  constexpr std::size_t missions = 30;
  List<MissionLoss> found;
  const bool is_endless = solver_->model.horizon == 0;
  if (!solver_->sarsop.has_start() || !(is_endless || solver_->is_nearly_closed())) return found;
  const double precision = std::max(solver_->gap(), 0.2 * solver_->nearly_closed_gap());
  return solver_->played(max_work, is_over, work, [&](Asked ends, Uniform uniform) {
    while (found.size() < missions && !ends()) found.push_back(solver_->sarsop.loss_of_mission(action, steps, precision, ends, is_over, uniform));
    return found;
  });
}

std::optional<PolicyValue> OnlineSarsop::best_policy(std::size_t steps, const Limit& usual, const Limit& most, std::uint64_t& work, bool decides_anew) {
  Sarsop& sarsop = solver_->sarsop;
  if (!sarsop.has_start() || (!decides_anew && (!switches::simple_policies || solver_->is_nearly_closed()))) return std::nullopt;
  auto is_late = solver_->seldom(usual.is_over), is_last = solver_->seldom(most.is_over);
  const std::uint64_t before = sarsop.graph().work();
  const auto is_over = [&] { return is_late() || (usual.work > 0 && sarsop.graph().work() - before >= usual.work); };
  return solver_->played(most.work, is_last, work, [&](Asked ends, Uniform uniform) {
    return sarsop.best_policy(steps, decides_anew, {is_over, is_late}, {ends, is_last}, uniform);
  });
}

void OnlineSarsop::open_actions(const IsOver& is_late) { solver_->sarsop.open_actions(is_late); }

List<ActionBounds> OnlineSarsop::action_bounds() {
  List<ActionBounds> bounds = solver_->sarsop.action_bounds();
  const double below = solver_->below(), above = solver_->above();
  for (ActionBounds& action : bounds) {
    action.lower -= below;
    action.upper += above;
  }
  return bounds;
}

std::pair<double, double> OnlineSarsop::bounds() {
  const Sarsop& sarsop = solver_->sarsop;
  return checked(sarsop.lower() - solver_->below(), sarsop.upper() + solver_->above());
}

std::pair<double, double> OnlineSarsop::extremes() const {
  const BeliefGraph& graph = solver_->sarsop.graph();
  return {std::min(graph.min_value(), 0.0), graph.max_value()};
}

}  // namespace aos::point_based
