// A small belief of listed states, and what it becomes after an action and an observation that is drawn.
#pragma once

#include "aos/planning/belief_tree/belief_tree_constants.hpp"
#include "aos/planning/belief_tree/sensing_tables.hpp"
#include "aos/planning/listed/state_space.hpp"

namespace aos {

using SmallBelief = List<std::pair<std::uint32_t, float>>;  // distinct states with weights that sum to 1

// Keeps some states of a belief, each with a probability that makes up for the others: systematic resampling.
inline void thin_out(SmallBelief& belief, std::size_t most, Sampler& random) {
  double total = 0;
  for (const auto& [state, weight] : belief) total += weight;
  const bool is_small = belief.size() <= most;
  const double each = total / most;
  double place = is_small ? 0 : random.uniform() * each;
  double below = 0;
  std::size_t kept = 0;
  for (const auto& [state, weight] : belief) {
    below += weight;
    double share = is_small ? weight / total : 0;
    for (; !is_small && place < below; place += each) share += 1 / static_cast<double>(most);
    if (share > 0) belief[kept++] = {state, static_cast<float>(share)};
  }
  belief.resize(kept);
}

template <class Model>
class SensedBelief {
 public:
  SensedBelief(const StateSpace<Model>& space, SensingTables<Model>& tables) : space_(space), tables_(tables) {}

  // Draws an observation and makes the belief after it, which `keep` makes small. Returns false if the mission has ended for
  // certain.
  bool draw(std::span<const SmallBelief::value_type> before, std::size_t action, bool is_root, Sampler& random) {
    std::uint64_t version = 0;
    do {  // again where tables have changed meanwhile
      version = tables_.version();
      start_.assign(before.begin(), before.end());
      if (is_root) thin_out(start_, tree_root_states, random);
      list_outcomes(action);
      if (running_ <= 0) return false;
      double place = random.uniform() * running_;
      std::size_t chosen = 0;
      while (chosen + 1 < outcomes_.size() && place >= outcomes_[chosen].weight) place -= outcomes_[chosen++].weight;
      tables_.draw(outcomes_[chosen].table, random, seen_);
      weigh(chosen);
    } while (version != tables_.version());
    return true;
  }
  void keep(Sampler& random) { thin_out(after_, tree_states, random); }

  // The states that the last draw began with.
  const SmallBelief& before() const { return start_; }
  const SmallBelief& after() const { return after_; }
  // The largest share of the belief after the draw, before `keep`, that is a belief of these states.
  double share_of(std::span<const SmallBelief::value_type> states) const {
    double least = std::numeric_limits<double>::infinity();
    double total = 0;
    for (const auto& [state, weight] : states) {
      const std::uint32_t place = place_[state];
      if (place >= after_.size() || after_[place].first != state) return 0;
      least = std::min<double>(least, after_[place].second / weight);
      total += weight;
    }
    double after = 0;
    for (const auto& [state, weight] : after_) after += weight;
    return std::min(least * total / after, 1.0);
  }
  // How many outcomes were weighed by the last call.
  std::size_t work() const { return outcomes_.size(); }

 private:
  struct Weighted {
    std::uint32_t next;
    std::uint32_t table;
    float weight;
  };

  void list_outcomes(std::size_t action) {
    outcomes_.clear();
    running_ = 0;
    const auto& rows = space_.rows().outcomes;
    for (const auto& [state, weight] : start_) {
      const std::size_t row = space_.rows().row(state, action);
      for (std::size_t place = rows.first[row]; place < rows.first[row + 1]; ++place) {
        const auto& outcome = rows.elements[place];
        outcomes_.push_back({outcome.next, tables_.table(row, place), static_cast<float>(weight * outcome.probability)});
        running_ += outcomes_.back().weight;
      }
    }
  }

  // Weighs the outcomes by the observation. The one that it was drawn from stays, however little that weighs.
  void weigh(std::size_t chosen) {
    constexpr float least = 1e-30f;
    place_.resize(space_.size());
    after_.clear();
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      const auto& [next, table, weight] = outcomes_[i];
      const auto likelihood = static_cast<float>(tables_.likelihood(table, seen_));
      const float posterior = weight * (i == chosen ? std::max(likelihood, least) : likelihood);
      if (posterior <= 0) continue;
      std::uint32_t& place = place_[next];
      if (place < after_.size() && after_[place].first == next) {
        after_[place].second += posterior;
      } else {
        place = after_.size();
        after_.push_back({next, posterior});
      }
    }
  }

  const StateSpace<Model>& space_;
  SensingTables<Model>& tables_;
  SmallBelief start_;
  List<Weighted> outcomes_;
  double running_ = 0;
  TabledObservation seen_;
  SmallBelief after_;
  List<std::uint32_t> place_;  // of states in `after_`
};

}
