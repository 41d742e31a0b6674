// One search by several threads. Each has a tree of its own and a fixed share of a budget in simulations, so that a seed gives
// the same result however the threads are scheduled. The values of the trees are merged by visits.
#pragma once

#include <exception>
#include <thread>

#include "aos/base/clock.hpp"
#include "aos/base/function_ref.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"
#include "aos/planning/pomcp/tree_search.hpp"

namespace aos {

template <class Model>
class SearchThreads {
 public:
  using Tree = TreeSearch<Model>;

  void prepare(int threads) {
    simulations_.clear();
    const std::size_t count = threads;
    if (trees_.size() == count) return;
    trees_.clear();
    for (std::size_t i = 0; i < count; ++i) trees_.push_back(std::make_unique<Tree>(max_search_bytes / count));
  }
  const List<std::unique_ptr<Tree>>& trees() const { return trees_; }
  // Of the last search, by thread.
  const List<std::uint64_t>& simulations() const { return simulations_; }

  // Simulates from `start_state(random)`, a state of simulated_state.hpp, until the budget is spent or
  // `is_over()`. Returns the number of simulations. `first` is that of TreeSearch. A budget in simulations is counted by the work
  // in the tree, with `each` operations to a simulation, or by descents if there are none, since each of these has a rollout.
  std::uint64_t simulate(const auto& start_state, Budget budget, PlanningClock::time_point start, Sampler& random,
                         int first, FunctionRef<bool()> is_over, Operations each) {
    List<Work> works(trees_.size());
    {
      List<std::jthread> others;
      for (std::size_t i = 1; i < trees_.size(); ++i) {
        const std::uint64_t seed = random.bits();
        others.emplace_back([&, i, seed] {
          blame::use_line(i);
          Sampler own{seed};
          works[i] = work(*trees_[i], start_state, share(budget, i), each, start, own, first, is_over);
        });
      }
      works[0] = work(*trees_[0], start_state, share(budget, 0), each, start, random, first, is_over);
    }
    std::uint64_t simulations = 0;
    simulations_.clear();
    for (const Work& done : works) {
      if (done.fault) {
        blame::at(done.piece);
        std::rethrow_exception(done.fault);
      }
      simulations += done.simulations;
      simulations_.push_back(done.simulations);
    }
    return simulations;
  }

 private:
  // The result of one thread, with a fault of model code and the piece that ran.
  struct Work {
    std::uint64_t simulations = 0;
    std::exception_ptr fault;
    std::uint32_t piece = 0;
  };

  static Budget share(Budget budget, std::size_t thread) {
    const std::uint64_t threads = budget.threads;
    if (budget.simulations > 0) budget.simulations = budget.simulations / threads + (thread < budget.simulations % threads);
    return budget;
  }

  static Work work(Tree& tree, const auto& start_state, Budget budget, Operations each,
                   PlanningClock::time_point start, Sampler& random, int first, FunctionRef<bool()> is_over) {
    constexpr std::uint64_t between_looks = 64;
    constexpr Operations start_cost = 30;
    const ForgottenTexts forgotten;
    Work done;
    try {
      const bool has_limit = budget.simulations > 0 || budget.seconds <= 0;
      std::uint64_t descents = 0;
      while (!has_limit || done.simulations < budget.simulations) {
        if (descents % between_looks == 0) {
          const bool has_searched = descents > 0 || first >= 0;  // a decision is never made blindly
          if (is_over() || (budget.seconds > 0 && has_searched && is_enough(tree, budget.seconds, start, descents, first))) break;
        }
        ++descents;
        auto state = start_state(random);
        if (!state.has_ended()) tree.simulate(state, first, random);
        done.simulations = each == 0 ? descents : (tree.work() + descents * start_cost + each - 1) / each;
      }
    } catch (...) {
      done.fault = std::current_exception();
      done.piece = blame::piece();
    }
    blame::at(0);
    return done;
  }

  static bool is_enough(const Tree& tree, double seconds, PlanningClock::time_point start, std::uint64_t simulations,
                        int first) {
    const double spent = seconds_since(start);
    if (spent >= seconds) return true;
    if (first >= 0 || spent < min_time_share * seconds) return false;
    return tree.is_decided(simulations * (seconds / spent - 1));
  }

  List<std::unique_ptr<Tree>> trees_;
  List<std::uint64_t> simulations_;
};

}
