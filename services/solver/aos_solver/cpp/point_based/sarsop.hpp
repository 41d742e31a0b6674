// Point-based value iteration near the beliefs that a good policy reaches (SARSOP: Kurniawati, Hsu and Lee, 2008).
//
// A trial follows the action with the highest upper bound and the observation that matters most for the gap at the root. It ends
// when nothing more can be learnt for the root, and both bounds are backed up along its path. One trial of three opens all
// actions and follows the highest lower bound, since upper bounds that are far too high say little about what is worth improving.
// The first trials from a belief repeat one action each: bounds hardly find what lies behind a long detour. Actions whose upper
// bound is below the belief's lower bound are dropped, and so are alpha vectors that are best at no remaining belief.
#pragma once

#include <string>
#include <tuple>

#include "aos/base/switches.hpp"
#include "point_based/backups.hpp"
#include "point_based/base_policies.hpp"
#include "point_based/belief_graph.hpp"
#include "point_based/online.hpp"
#include "point_based/trial.hpp"

namespace aos::point_based {

// Both bounds for a report. Throws CrossedBounds.
inline std::pair<double, double> checked(double lower, double upper) {
  if (lower <= upper) return {lower, upper};
  throw CrossedBounds("the lower bound " + std::to_string(lower) + " is above the upper bound " + std::to_string(upper));
}

class Sarsop {
 public:
  Sarsop(const FlatModel& model, const Regions& regions)
      : model_(model), regions_(regions), graph_(model, regions), left_(static_cast<std::uint32_t>(model.horizon)) {
    for (const Start& start : model.starts) add_start(start);
  }
  Sarsop(const Sarsop&) = delete;  // the parts refer to one another

  // The bounds of the value of the start, discounted. The lower one is what the best known policy gives at least.
  double lower() const { return over_roots(&Node::lower, -1); }
  double upper() const { return over_roots(&Node::upper, 1); }
  // Whether there is a start from which the mission goes on.
  bool has_start() const { return !roots_.empty(); }
  const BeliefGraph& graph() const { return graph_; }
  std::uint64_t backups() const { return backups_.count(); }
  std::size_t vectors() const {
    std::size_t count = 0;
    for (std::uint32_t region = 0; region < regions_.all.size(); ++region) count += graph_.lower(region).kept();
    return count;
  }

  // Forgets what trials have found out.
  void start_over() {
    forget_roots();
    graph_.start_over();
    backups_.vectors_added = 0;
    patience_ = 1;
    policies_.start_over();
    trial_.start_over();
  }

  // Continues from another belief with as many decisions left, at most those of the model. Beliefs that are known are kept; beyond
  // `max_bytes`, only useful alpha vectors are.
  void move_to(const Start& start, std::size_t left, std::size_t max_bytes) {
    left_ = static_cast<std::uint32_t>(left);
    if (graph_.bytes() > max_bytes) {
      prune([] { return false; });
      graph_.forget_beliefs();
    }
    forget_roots();
    add_start(start);
  }

  // Runs one trial with its backups. `is_over()` cuts the trial short, and `is_late()` its backups, too. Returns whether there may be
  // more to find out.
  bool improve(double precision, Asked is_over, Asked is_late) {
    const auto widest = std::ranges::max_element(roots_, {}, [this](const Root& root) { return weighted_gap(root); });
    return widest != roots_.end() && improve_from(widest->node, precision, is_over, is_late);
  }

  // Runs one trial below an action that is being carried out at the only start.
  bool improve_below(std::uint32_t action, double precision, Asked is_over, Asked is_late) {
    if (roots_.empty()) return false;
    Branch& branch = root_branch(action);
    graph_.open(graph_[roots_.front().node], branch);
    backups_.refreshed_lower(branch);
    backups_.refreshed_upper(branch);
    const Successor* next = trial_.widest_of(branch.successors, precision);
    return next != nullptr && improve_from(next->node, precision, is_over, is_late);
  }

  // Opens all actions at the only start, unless `is_late()` comes first.
  void open_actions(Asked is_late) {
    for (std::uint32_t action = 0; action < model_.actions && !roots_.empty() && !is_late(); ++action) {
      graph_.open(graph_[roots_.front().node], root_branch(action));
    }
  }

  // The bounds of all actions at the only start.
  List<ActionBounds> action_bounds() {
    List<ActionBounds> bounds(model_.actions);
    if (roots_.empty()) return bounds;
    const double weight = roots_.front().weight;
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      Branch& branch = root_branch(action);
      if (branch.is_open) backups_.refresh(branch);
      const double lower = branch.is_open ? branch.lower : graph_.least(graph_[roots_.front().node], branch);
      double goes_on = branch.is_open ? branch.rest : 1;
      for (const Successor& successor : branch.successors) goes_on += successor.probability;
      bounds[action] = {moved(weight * lower, -1), moved(weight * branch.upper, 1), trial_.begun()[action],
                        std::min(moved(weight * goes_on, 1), 1.0)};
    }
    return bounds;
  }

  // Plays `steps` decisions of a mission from the only start. It begins with `action` and decides anew at each later belief,
  // with the whole horizon to go. Tells what it earns less in them than the lower bound says: it may put off for ever what is
  // best at the end of a horizon, and without a horizon the bound counts what comes after these decisions, too. Most luck is
  // left out, since a step counts by what it is expected to change of the lower bound. At `is_over()` the mission breaks off, since
  // decisions without a search would be others: what is left of it loses as much as what was played. `uniform()` draws.
  MissionLoss loss_of_mission(std::uint32_t action, std::size_t steps, double precision, Asked is_over, Asked is_late, Uniform uniform) {
    const List<std::uint32_t> begun = trial_.begun();
    std::uint32_t number = roots_.front().node;
    graph_.refresh_lower(graph_[number]);
    double promised = graph_[number].lower;
    bool is_settled = true;
    MissionLoss loss;
    double discount = roots_.front().weight, played = 0;
    const double all_promised = std::abs(discount * promised);
    std::size_t step = 0;
    for (; step < steps; ++step) {
      if (step > 0) std::tie(action, is_settled) = decided_anew(anew_of(number), precision, is_over, is_late);
      if (step > 0 && is_over()) break;
      const Branch branch = opened(number, action);
      const double lost = discount * (promised - branch.lower);
      played += discount;
      loss.all += lost;
      if (!is_settled) loss.unsettled += lost;
      double place = uniform();
      const auto next = std::find_if(branch.successors.begin(), branch.successors.end(),
                                     [&](const Successor& successor) { return (place -= successor.probability) < 0; });
      if (next == branch.successors.end()) {
        promised = 0;
        step = steps;
        break;
      }
      number = next->node;
      graph_.refresh_lower(graph_[number]);
      promised = graph_[number].lower;
      discount *= model_.discount;
    }
    if (step < steps && all_promised > 0) loss.played = std::max(1 - std::abs(discount * promised) / all_promised, 0.0);
    double all = played;
    for (; step < steps; ++step, discount *= model_.discount) all += discount;
    loss.all *= all / played;
    loss.unsettled *= all / played;
    if (model_.horizon == 0) loss.later = discount * promised;
    trial_.set_begun(begun);
    return loss;
  }

  // What the best of some simple policies returns from the only start (base_policies.hpp).
  std::optional<PolicyValue> best_policy(std::size_t steps, bool decides_anew, const Ends& usual, const Ends& most, Uniform uniform) {
    const auto found = policies_.best(graph_[roots_.front().node], steps, decides_anew, usual, most, uniform);
    if (!found) return found;
    const double weight = roots_.front().weight;
    return PolicyValue{found->action, weight * found->value, weight * found->within, weight * found->standard_error};
  }

  // Gives up the alpha vectors that are best at no belief that the remaining actions reach. If `is_late()` comes first, all are kept,
  // and more are added before the next try.
  void prune(Asked is_late) {
    constexpr std::size_t between_looks = 64;  // at the clock, in beliefs
    backups_.vectors_added = 0;
    patience_ *= 2;
    List<std::vector<bool>> is_best(regions_.all.size());
    for (std::uint32_t region = 0; region < is_best.size(); ++region) {
      is_best[region].resize(graph_.lower(region).size());
    }
    std::vector<bool> is_reached(graph_.size());
    List<std::uint32_t> waiting;
    const auto reach = [&](std::uint32_t number) {
      if (is_reached[number]) return;
      is_reached[number] = true;
      waiting.push_back(number);
    };
    for (const Root& root : roots_) reach(root.node);
    for (std::size_t reached = 0; !waiting.empty(); ++reached) {
      if (reached % between_looks == 0 && is_late()) return;
      Node& node = graph_[waiting.back()];
      waiting.pop_back();
      graph_.refresh_lower(node);
      is_best[node.region][node.vector] = true;
      for (const Branch& branch : node.branches) {
        for (const Successor& successor : branch.successors) reach(successor.node);
      }
    }
    for (std::uint32_t region = 0; region < regions_.all.size(); ++region) {
      LowerBound& bound = graph_.lower(region);
      for (std::uint32_t number = bound.initial(); number < bound.size(); ++number) {
        if (!is_best[region][number] && !bound[number].is_gone()) bound.give_up(number);
      }
    }
    patience_ = 1;
  }

 private:
  struct Root {
    double weight;
    std::uint32_t node;
  };
  void forget_roots() {
    roots_.clear();
    dropped_at_root_.clear();
    trial_.forget_begun();
    idle_ = 0;
    persisted_ = 0;
  }

  void add_start(const Start& start) {
    Belief belief;
    List<std::pair<std::uint32_t, double>> entries;
    double total = 0;
    std::uint32_t region = nowhere;
    for (const auto& [state, probability] : start.belief) {
      if (regions_.region_of[state] == nowhere || probability <= 0) continue;
      region = regions_.region_of[state];
      entries.emplace_back(regions_.local_of[state], probability);
      total += probability;
    }
    if (region == nowhere) return;
    std::sort(entries.begin(), entries.end());
    for (const auto& [local, probability] : entries) {
      belief.states.push_back(local);
      belief.probabilities.push_back(probability / total);
    }
    const double share = start.weight * total;
    roots_.push_back({share, graph_.node_of(region, left_, belief)});
  }

  // The branch of an action with fresh bounds, also of one that was dropped.
  Branch opened(std::uint32_t number, std::uint32_t action) {
    Node& node = graph_[number];
    graph_.expand(node);
    const Branch* const known = node.branch_of(action);
    Branch branch = known != nullptr ? *known : graph_.closed_branch(node, action);
    graph_.open(node, branch);
    backups_.refresh(branch);
    return branch;
  }

  // The node of a belief with the whole horizon to go.
  std::uint32_t anew_of(std::uint32_t number) {
    const Belief belief = graph_[number].belief;
    return graph_.node_of(graph_[number].region, left_, belief);
  }

  // The action with the highest lower bound at a belief, after a search for a gap of at most `precision`, and whether it is
  // proven to be the best. Any action if `is_late()` comes first.
  std::pair<std::uint32_t, bool> decided_anew(std::uint32_t number, double precision, Asked is_over, Asked is_late) {
    const auto is_closed = [&] {
      Node& node = graph_[number];
      graph_.refresh_lower(node);
      graph_.refresh_upper(node);
      return node.upper - node.lower <= precision;
    };
    const std::uint32_t persisted = std::exchange(persisted_, static_cast<std::uint32_t>(model_.actions));
    idle_ = 0;
    while (!is_over() && !is_closed() && improve_from(number, precision, is_over, is_late)) {}
    persisted_ = persisted;
    idle_ = 0;
    std::uint32_t best = graph_.lower(graph_[number].region)[graph_[number].vector].action;
    double highest = -std::numeric_limits<double>::infinity();
    List<double> uppers;
    for (std::uint32_t action = 0; action < model_.actions; ++action) {
      if (is_late()) return {best, false};
      const Branch branch = opened(number, action);
      uppers.push_back(branch.upper);
      if (branch.lower <= highest) continue;
      highest = branch.lower;
      best = action;
    }
    uppers[best] = -std::numeric_limits<double>::infinity();
    return {best, *std::max_element(uppers.begin(), uppers.end()) < highest};
  }

  // Runs one trial. Returns false after three in a row, one of them by the lower bound, that learnt nothing.
  bool improve_from(std::uint32_t number, double precision, Asked is_over, Asked is_late) {
    const bool persists = switches::repeated_trials && persisted_ < model_.actions;
    bool has_learnt = persists ? trial_.persist(number, persisted_++, is_over) : trial_.sample(number, precision, is_over);
    for (auto step = trial_.path().rbegin(); step != trial_.path().rend() && !is_late(); ++step) {
      if (backups_.backup(*step)) has_learnt = true;
    }
    if (backups_.vectors_added > patience_ * std::max<std::size_t>(200, vectors() / 4) && !is_late()) prune(is_late);
    idle_ = has_learnt || persists ? 0 : idle_ + 1;
    return idle_ < 3;
  }

  // A bound, moved outwards by more than rounding can have moved it inwards.
  double moved(double value, double direction) const { return value + direction * 8 * graph_.rounding() * std::abs(value); }

  double over_roots(double Node::*bound, double direction) const {
    double sum = 0;
    double size = 0;
    for (const Root& root : roots_) {
      const double value = root.weight * graph_[root.node].*bound;
      sum += value;
      size += std::abs(value);
    }
    return sum + direction * 8 * graph_.rounding() * size;
  }

  double weighted_gap(const Root& root) const {
    const Node& node = graph_[root.node];
    return root.weight * (node.upper - node.lower);
  }

  // The branch of an action at the only start, also of one that was dropped there.
  Branch& root_branch(std::uint32_t action) {
    Node& node = graph_[roots_.front().node];
    graph_.expand(node);
    Branch* branch = node.branch_of(action);
    if (branch == nullptr) {
      const auto dropped = std::ranges::find(dropped_at_root_, action, &Branch::action);
      branch = dropped != dropped_at_root_.end() ? &*dropped : &dropped_at_root_.emplace_back(graph_.closed_branch(node, action));
    }
    return *branch;
  }

  const FlatModel& model_;
  const Regions& regions_;
  BeliefGraph graph_;
  Backups backups_{model_, regions_, graph_};
  BasePolicies policies_{model_, regions_, graph_};
  Trial trial_{model_, graph_, backups_};
  List<Root> roots_;
  std::uint32_t left_;           // decisions at the roots; 0 without a horizon
  std::uint32_t persisted_ = 0;  // how many actions were repeated from the current roots
  std::size_t patience_ = 1;     // how many times as many vectors are added before they are pruned
  int idle_ = 0;                 // how many trials in a row have learnt nothing
  std::deque<Branch> dropped_at_root_;
};

}
