// Policies in belief space that need no search: what they return from a belief, by simulation. Where there are hundreds of
// actions, a search hardly opens them, and a policy that asks what tells most, and acts once it knows enough, is found at once.
// A policy of this file takes the action with the highest sum of
//
//   the reward, a share of what follows if more is known from then on (QMDP: Littman, Cassandra and Kaelbling, 1995), and
//   a weight times the mutual information between the state and the next observation.
//
// Missions are played by each in turns. The better half goes on, until one is left, and so does the policy that decided last.
#pragma once

#include "aos/base/statistics.hpp"
#include "point_based/belief_graph.hpp"
#include "point_based/constants.hpp"
#include "point_based/online.hpp"

namespace aos::point_based {

class BasePolicies {
 public:
  BasePolicies(const FlatModel& model, const Regions& regions, BeliefGraph& graph)
      : model_(model), regions_(regions), graph_(graph) {
    posterior_.reserve(regions.largest());
    doubts_.resize(regions.all.size() * model.actions);
  }

  // The policy that returns most from a node's belief over `steps` decisions, and what it returns; none if too few missions
  // were played when `is_over()` came. `is_late()` also breaks off the last one. `uniform()` draws. Where it `decides_anew`, each
  // decision has the whole horizon to go. Else it must return more than the lower bound by a standard error, or by anything if
  // it was found last.
  [[gnu::optimize("O3")]] std::optional<PolicyValue> best(const Node& node, std::size_t steps, bool decides_anew, Asked is_over, Asked is_late, Uniform uniform) {
    decides_anew_ = decides_anew;
    const double worth = std::max(node.upper - node.lower, 0.0);  // of knowing all
    List<Candidate> candidates;
    for (const Policy& policy : policies_) candidates.push_back({&policy, policy.weight * worth});
    std::size_t missions = first_missions;
    while (true) {
      for (std::size_t i = 0; i < missions; ++i) {
        for (Candidate& candidate : candidates) {
          if (!is_over()) play(node, candidate, steps, is_late, uniform);
        }
      }
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Candidate& one, const Candidate& other) { return mean(one) > mean(other); });
      if (is_over() || missions == most_missions) {
        return decides_anew ? value_of(candidates.front()) : decider(candidates.front(), node.lower);
      }
      const std::size_t half = candidates.size() / 2;
      std::size_t place = 0;
      erase_if(candidates, [&](const Candidate& candidate) {
        return place++ >= half && (decides_anew || candidate.policy != last_);
      });
      missions = half > 1 ? 2 * missions : most_missions;
      if (half > 1) continue;
      // The mean of the best of several is too high. What the last ones return is found anew.
      for (Candidate& candidate : candidates) candidate.returns = {};
    }
  }

  // Forgets which policy was found last.
  void start_over() { last_ = nullptr; }

 private:
  struct Policy {
    double share;   // of what follows
    double weight;  // of a nat, in the worth of knowing all
  };
  struct Returns : SampleMean {
    double within = 0;  // what missions earn within their steps, in all
  };
  struct Candidate {
    const Policy* policy;
    double weight;  // of a nat
    Returns returns{};
    std::uint32_t first = 0;  // its action at the belief where missions begin
  };

  static constexpr Policy policies_[] = {{1, 0}, {1, 0.1}, {0.9, 0.03}, {0.9, 0.1}, {0.9, 0.3}, {0.9, 1}};

  static double mean(const Candidate& candidate) {
    return candidate.returns.count() > 0 ? candidate.returns.mean() : -std::numeric_limits<double>::infinity();
  }
  static std::optional<PolicyValue> value_of(const Candidate& candidate) {
    const Returns& returns = candidate.returns;
    if (returns.count() < static_cast<double>(fewest_missions)) return std::nullopt;
    return PolicyValue{candidate.first, returns.mean(), returns.within / returns.count(), returns.error()};
  }

  // As `value_of`, where it decides.
  std::optional<PolicyValue> decider(const Candidate& candidate, double least) {
    std::optional<PolicyValue> found = value_of(candidate);
    if (found && found->value - (candidate.policy == last_ ? 0 : found->standard_error) <= least) found.reset();
    last_ = found ? candidate.policy : nullptr;
    return found;
  }

  // Plays a mission, which counts if it ends before `is_late()`. What comes after its steps counts as the lower bound there, where
  // the search has no horizon.
  [[gnu::optimize("O3")]] void play(const Node& start, Candidate& candidate, std::size_t steps, Asked is_late, Uniform uniform) {
    Belief belief = start.belief;
    std::uint32_t region = start.region;
    std::uint32_t action = candidate.first;
    double discount = 1, earned = 0, later = 0;
    for (std::size_t step = 0; step < steps; ++step) {
      const std::uint32_t passed = graph_.is_endless() || decides_anew_ ? 0 : static_cast<std::uint32_t>(step);
      const std::uint32_t left = start.left - passed;
      if (step > 0 || candidate.returns.count() == 0) action = choice(belief, region, left, candidate, is_late);
      if (is_late()) return;
      if (step == 0) candidate.first = action;
      const Move& move = regions_.all[region].moves[action];
      earned += discount * expected(move.rewards, belief);
      discount *= model_.discount;
      const ObservationBranch* const observed = observation(belief, move, uniform());
      if (observed == nullptr) {
        discount = 0;
        break;
      }
      belief = posterior_.normalised(posterior_.observe(*observed), 1e-9);
      region = observed->region;
    }
    if (graph_.is_endless() && discount > 0) later = discount * graph_.lower_at(region, belief);
    candidate.returns.within += earned;
    candidate.returns.add(earned + later);
  }

  // The observation at `place` in the distribution of all; null if the mission ends. The posterior has its prediction.
  [[gnu::optimize("O3")]] const ObservationBranch* observation(const Belief& belief, const Move& move, double place) {
    graph_.count_work(posterior_.predict(belief, move));
    for (const ObservationBranch& branch : move.observation_branches) {
      graph_.count_work(branch.successors.size());
      if ((place -= posterior_.probability_of(branch)) < 0) return &branch;
    }
    return nullptr;
  }

  // The action that a policy takes; any one if `is_late()` comes first.
  [[gnu::optimize("O3")]] std::uint32_t choice(const Belief& belief, std::uint32_t region, std::uint32_t left, const Candidate& candidate, Asked is_late) {
    const List<double> informed = graph_.informed_values(region, left, belief);
    graph_.count_work(model_.actions * belief.size());
    std::uint32_t best = 0;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t action = 0; action < model_.actions && !is_late(); ++action) {
      const Move& move = regions_.all[region].moves[action];
      const double reward = expected(move.rewards, belief);
      double merit = reward + candidate.policy->share * (informed[action] - reward);
      if (candidate.weight > 0) merit += candidate.weight * information(belief, region, action);
      if (merit <= highest) continue;
      highest = merit;
      best = action;
    }
    return best;
  }

  // The mutual information between the state and what is observed after an action, in nats.
  [[gnu::optimize("O3")]] double information(const Belief& belief, std::uint32_t region, std::uint32_t action) {
    const Move& move = regions_.all[region].moves[action];
    if (move.observation_branches.size() < 2 || belief.size() < 2) return 0;
    graph_.count_work(posterior_.predict(belief, move));
    double entropy = 0;
    for (const ObservationBranch& branch : move.observation_branches) {
      graph_.count_work(branch.successors.size());
      entropy += share_of_entropy(posterior_.probability_of(branch));
    }
    return std::max(entropy - expected(doubts(region, action), belief), 0.0);
  }

  // By state of the region: the entropy of what is observed after an action.
  [[gnu::optimize("O3")]] const List<double>& doubts(std::uint32_t region, std::uint32_t action) {
    List<double>& known = doubts_[region * model_.actions + action];
    if (!known.empty()) return known;
    const Move& move = regions_.all[region].moves[action];
    List<List<std::pair<std::size_t, double>>> observed(move.targets);  // by target: branches, and their probabilities
    for (std::size_t number = 0; number < move.observation_branches.size(); ++number) {
      for (const auto& successor : move.observation_branches[number].successors) observed[successor.target].emplace_back(number, successor.probability);
    }
    List<double> odds(move.observation_branches.size(), 0.0);
    List<std::size_t> possible;
    for (std::uint32_t state = 0; state < regions_.all[region].states.size(); ++state) {
      possible.clear();
      for (const Move::Flow& flow : move.flows[state]) {
        for (const auto& [number, probability] : observed[flow.target]) {
          odds[number] += flow.probability * probability;
          possible.push_back(number);
        }
      }
      double entropy = 0;
      for (const std::size_t number : possible) entropy += share_of_entropy(std::exchange(odds[number], 0.0));
      graph_.count_work(possible.size());
      known.push_back(entropy);
    }
    graph_.count_work(move.targets);
    return known;
  }

  const FlatModel& model_;
  const Regions& regions_;
  BeliefGraph& graph_;
  Posterior posterior_;
  bool decides_anew_ = false;
  const Policy* last_ = nullptr;  // that decided, if one did at the last search
  List<List<double>> doubts_;  // [region * actions + action]
};

}
