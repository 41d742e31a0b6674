// Policies in belief space that need no search: what they return from a belief, by simulation. Where there are hundreds of
// actions, a search hardly opens them, and a policy that asks what tells most, and acts once it knows enough, is found at once.
// A policy of this file takes the action with the highest sum of
//
//   the reward, a share of what follows if more is known from then on (QMDP: Littman, Cassandra and Kaelbling, 1995), and
//   a weight times the mutual information between the state and the next observation.
//
// Each plays the fewest missions that tell a mean, and then more of them in turns. The better half goes on, until one is left, and
// so does the policy that decided last.
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
    sensors_.resize(regions.all.size() * model.actions);
  }

  // The policy that returns most from a node's belief over `steps` decisions, and what it returns; none if no mission was
  // played. The first policy has the fewest missions that tell a mean until the `most` ends, all others end at the `usual` ones.
  // `uniform()` draws. Where it `decides_anew`, each decision has the whole horizon to go. Else it must return more than the lower bound by a
  // standard error, or by anything if it was found last.
  [[gnu::optimize("O3")]] std::optional<PolicyValue> best(const Node& node, std::size_t steps, bool decides_anew, const Ends& usual, const Ends& most, Uniform uniform) {
    decides_anew_ = decides_anew;
    const double worth = std::max(node.upper - node.lower, 0.0);  // of knowing all
    List<Candidate> candidates;
    const Prospects now = prospects(node.belief, node.region, node.left, /*is_to_tell=*/true, most.late);
    for (const Policy& policy : policies_) {
      Candidate& added = candidates.emplace_back(&policy, policy.weight * worth);
      added.first = choice(now, added);
    }
    // Where few missions fit, the policy that decided last is compared first, and then the one that asks nothing: its missions are cheap.
    std::ranges::stable_partition(candidates, [](const Candidate& candidate) { return candidate.weight == 0; });
    std::ranges::stable_partition(candidates, [this](const Candidate& candidate) { return candidate.policy == last_; });
    for (Candidate& candidate : candidates) {
      const Ends& ends = &candidate - candidates.data() < 2 ? most : usual;
      for (std::size_t i = 0; i < fewest_missions && !ends.over(); ++i) play(node, candidate, steps, ends.late, uniform);
    }
    std::size_t missions = first_missions - fewest_missions;
    while (true) {
      for (std::size_t i = 0; i < missions; ++i) {
        for (Candidate& candidate : candidates) {
          if (!usual.over()) play(node, candidate, steps, usual.late, uniform);
        }
      }
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Candidate& one, const Candidate& other) { return mean(one) > mean(other); });
      if (usual.over() || missions == most_missions) {
        return decides_anew ? value_of(candidates.front()) : decider(candidates, node.lower, worth);
      }
      const std::size_t half = candidates.size() / 2;
      std::size_t place = 0;
      erase_if(candidates, [&](const Candidate& candidate) {
        return place++ >= half && (decides_anew || candidate.policy != last_);
      });
      missions = half > 1 ? 2 * first_missions : most_missions;
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

  static constexpr Policy policies_[] = {{0.9, 0.1}, {0.9, 0.3}, {0.9, 0.03}, {1, 0.1}, {0.9, 1}, {1, 0}};

  static double mean(const Candidate& candidate) {
    return candidate.returns.count() > 0 ? candidate.returns.mean() : -std::numeric_limits<double>::infinity();
  }
  // `fewest` missions tell how far returns lie apart.
  static std::optional<PolicyValue> value_of(const Candidate& candidate, std::size_t fewest = fewest_missions) {
    const Returns& returns = candidate.returns;
    if (returns.count() < static_cast<double>(fewest)) return std::nullopt;
    return PolicyValue{candidate.first, returns.mean(), returns.within / returns.count(), returns.error()};
  }

  // The value of the first candidate that decides. The returns of too few missions may lie as far apart as the bounds.
  std::optional<PolicyValue> decider(const List<Candidate>& candidates, double least, double worth) {
    const Policy* const before = std::exchange(last_, nullptr);
    for (const Candidate& candidate : candidates) {
      std::optional<PolicyValue> found = value_of(candidate, 1);
      if (!found) continue;
      if (!value_of(candidate)) found->standard_error = worth / 2 / std::sqrt(candidate.returns.count());
      // A mission that does what the bound's plan does may return more than that by rounding.
      if (found->value - (candidate.policy == before ? 0 : found->standard_error) <= least + closed_share * worth) continue;
      last_ = candidate.policy;
      return found;
    }
    return std::nullopt;
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
      if (step > 0) action = choice(prospects(belief, region, left, candidate.weight > 0, is_late), candidate);
      if (is_late()) return;
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

  // What is told of each action at a belief.
  struct Prospects {
    List<double> rewards;
    List<double> informed;     // values if more is known from then on
    List<double> information;  // of the next observation; empty if nobody asks
  };

  // Any values if `is_late()` comes first.
  [[gnu::optimize("O3")]] Prospects prospects(const Belief& belief, std::uint32_t region, std::uint32_t left, bool is_to_tell, Asked is_late) {
    Prospects found{{}, graph_.informed_values(region, left, belief), {}};
    graph_.count_work(model_.actions * belief.size());
    for (const Move& move : regions_.all[region].moves) found.rewards.push_back(move.sure_reward ? *move.sure_reward : expected(move.rewards, belief));
    if (!is_to_tell) return found;
    found.information.assign(model_.actions, 0.0);
    for (std::uint32_t action = 0; action < model_.actions && !is_late(); ++action) found.information[action] = information(belief, region, action);
    return found;
  }

  // The action that a policy takes.
  std::uint32_t choice(const Prospects& of, const Candidate& candidate) const {
    return best_of(static_cast<int>(model_.actions), [&](int action) {
      double merit = of.rewards[action] + candidate.policy->share * (of.informed[action] - of.rewards[action]);
      if (candidate.weight > 0) merit += candidate.weight * of.information[action];
      return merit;
    });
  }

  // What is observed after an action, by state of the region.
  struct Sensor {
    List<double> doubts;      // entropies
    List<List<double>> odds;  // by branch, where these are few: probabilities. Without the last one, where they sum to 1.
  };

  // Values by state, or only one if it is the same in all states.
  static void shorten(List<double>& values) {
    if (std::ranges::all_of(values, [&](double value) { return value == values.front(); })) values.resize(1);
  }
  static double expected_of(const List<double>& values, const Belief& belief) {
    return values.size() == 1 ? values.front() : expected(values, belief);
  }

  // The mutual information between the state and what is observed after an action, in nats.
  [[gnu::optimize("O3")]] double information(const Belief& belief, std::uint32_t region, std::uint32_t action) {
    const Move& move = regions_.all[region].moves[action];
    if (move.observation_branches.size() < 2 || belief.size() < 2) return 0;
    const Sensor& sensor = sensor_of(region, action);
    double entropy = 0;
    if (sensor.odds.empty()) {
      graph_.count_work(posterior_.predict(belief, move));
      for (const ObservationBranch& branch : move.observation_branches) {
        graph_.count_work(branch.successors.size());
        entropy += share_of_entropy(posterior_.probability_of(branch));
      }
    } else {
      double rest = 1;
      for (const List<double>& odds : sensor.odds) {
        const double share = expected_of(odds, belief);
        entropy += share_of_entropy(share);
        rest -= share;
      }
      graph_.count_work(sensor.odds.size() * belief.size());
      if (sensor.odds.size() < move.observation_branches.size()) entropy += share_of_entropy(std::max(rest, 0.0));
    }
    return std::max(entropy - expected_of(sensor.doubts, belief), 0.0);
  }

  // A branch, and its probability where it is known to what the action leads.
  struct Observed {
    std::size_t number;
    double probability;
  };

  static Rows<Observed> observed_at_targets(const Move& move) {
    Rows<Observed> observed;
    observed.first.assign(move.targets + 1, 0);
    for (const ObservationBranch& branch : move.observation_branches) {
      for (const auto& successor : branch.successors) ++observed.first[successor.target + 1];
    }
    std::partial_sum(observed.first.begin(), observed.first.end(), observed.first.begin());
    observed.elements.resize(observed.first.back());
    auto places = observed.first;
    for (std::size_t number = 0; number < move.observation_branches.size(); ++number) {
      for (const auto& successor : move.observation_branches[number].successors) {
        observed.elements[places[successor.target]++] = {number, successor.probability};
      }
    }
    return observed;
  }

  [[gnu::optimize("O3")]] const Sensor& sensor_of(std::uint32_t region, std::uint32_t action) {
    Sensor& known = sensors_[region * model_.actions + action];
    if (!known.doubts.empty()) return known;
    const Move& move = regions_.all[region].moves[action];
    const std::size_t states = regions_.all[region].states.size();
    const Rows<Observed> observed = observed_at_targets(move);
    List<double> odds(move.observation_branches.size(), 0.0);
    if (odds.size() <= few_branches) known.odds.assign(odds.size(), List<double>(states, 0.0));
    List<std::size_t> possible;
    bool is_whole = true;
    for (std::uint32_t state = 0; state < states; ++state) {
      possible.clear();
      for (const Move::Flow& flow : move.flows[state]) {
        for (const auto& [number, probability] : observed[flow.target]) {
          odds[number] += flow.probability * probability;
          possible.push_back(number);
        }
      }
      double entropy = 0, whole = 0;
      for (const std::size_t number : possible) {
        const double share = std::exchange(odds[number], 0.0);
        entropy += share_of_entropy(share);
        whole += share;
        if (!known.odds.empty()) known.odds[number][state] += share;
      }
      graph_.count_work(possible.size());
      known.doubts.push_back(entropy);
      is_whole = is_whole && std::abs(whole - 1) < 1e-9;
    }
    if (is_whole && !known.odds.empty()) known.odds.pop_back();
    shorten(known.doubts);
    graph_.count_work(move.targets);
    return known;
  }

  const FlatModel& model_;
  const Regions& regions_;
  BeliefGraph& graph_;
  Posterior posterior_;
  bool decides_anew_ = false;
  const Policy* last_ = nullptr;  // that decided, if one did at the last search
  List<Sensor> sensors_;  // [region * actions + action]; those that were asked for
};

}
