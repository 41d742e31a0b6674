// What one decision's simulations found at the root besides values: immediate rewards, and the range of returns, by which a
// budget in time ends once the choice cannot change.
#pragma once

#include "aos/planning/budget.hpp"
#include "aos/planning/pomcp/search_tree.hpp"

namespace aos {

class RootRecord {
 public:
  explicit RootRecord(std::size_t action_count = 0) : rewards_(action_count) {}

  void add_reward(std::size_t action, double reward) {
    rewards_[action].sum += reward;
    rewards_[action].n += 1;
  }
  void add_return(double seen) {
    lowest_ = std::min(lowest_, seen);
    highest_ = std::max(highest_, seen);
  }

  double mean_reward(std::size_t action) const {
    const auto& [sum, n] = rewards_[action];
    return n > 0 ? sum / n : 0;
  }

  // Whether `more` further simulations could not change the choice. In the worst case, all of them give
  // another action the highest return seen, or give the best action the lowest one.
  bool is_decided(const HistoryNode& root, const ActionNode* actions, const BarredActions& barred, double more) const {
    if (root.n < settled_visits || barred.contains(root.best)) return false;
    const auto moved = [&](const ActionNode& node, double to) {
      return node.n > 0 ? (node.n * node.q + more * to) / (node.n + more) : to;
    };
    const double min_best = moved(actions[root.best], lowest_);
    for (std::size_t a = 0; a < rewards_.size(); ++a) {
      if (a != root.best && !barred.contains(a) && moved(actions[a], highest_) >= min_best) return false;
    }
    return true;
  }

 private:
  struct Rewards {
    double sum = 0;
    double n = 0;
  };

  List<Rewards> rewards_;
  double lowest_ = std::numeric_limits<double>::infinity();
  double highest_ = -std::numeric_limits<double>::infinity();
};

}
