// Bayes' rule between regions: what an action predicts from a belief, and the belief after an observation.
#pragma once

#include "point_based/bounds.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

// Computes one posterior at a time. The memory is used again for the next one.
class Posterior {
 public:
  // Makes room for regions of up to `states` states.
  void reserve(std::size_t states) { dense_.assign(states, 0.0); }

  // Predicts what an action leads to from a belief. Returns the number of multiplications.
  [[gnu::optimize("O3")]] std::uint64_t predict(const Belief& belief, const Move& move) {
    std::uint64_t work = 0;
    predicted_.assign(move.targets, 0.0);
    for (std::size_t i = 0; i < belief.size(); ++i) {
      const auto flows = move.flows[belief.states[i]];
      for (const auto& flow : flows) predicted_[flow.target] += belief.probabilities[i] * flow.probability;
      work += flows.size();
    }
    return work;
  }

  [[gnu::optimize("O3")]] double probability_of(const ObservationBranch& branch) const {
    double total = 0;
    for (const ObservationBranch::Successor& successor : branch.successors) {
      total += predicted_[successor.target] * successor.probability;
    }
    return total;
  }

  // Computes the weights after an observation. Returns their sum, which is the observation's probability.
  [[gnu::optimize("O3")]] double observe(const ObservationBranch& branch) {
    belief_.states.clear();
    belief_.probabilities.clear();
    double total = 0;
    for (const ObservationBranch::Successor& successor : branch.successors) {
      const double weight = predicted_[successor.target] * successor.probability;
      if (weight <= 0) continue;
      total += weight;
      if (branch.is_ascending || dense_[successor.local] == 0) belief_.states.push_back(successor.local);
      if (branch.is_ascending) belief_.probabilities.push_back(weight);
      else dense_[successor.local] += weight;
    }
    if (branch.is_ascending) return total;
    if (!std::ranges::is_sorted(belief_.states)) std::ranges::sort(belief_.states);
    for (const std::uint32_t local : belief_.states) belief_.probabilities.push_back(std::exchange(dense_[local], 0.0));
    return total;
  }

  // The weights as a belief, given their sum. States with no more than `negligible` probability are left out.
  const Belief& normalised(double total, double negligible) {
    weights_ = belief_.probabilities;
    weighted_ = belief_.states;
    std::size_t kept = 0;
    double sum = 0;
    for (std::size_t i = 0; i < belief_.size(); ++i) {
      if (belief_.probabilities[i] <= negligible * total) continue;
      belief_.states[kept] = belief_.states[i];
      belief_.probabilities[kept++] = belief_.probabilities[i];
      sum += belief_.probabilities[kept - 1];
    }
    belief_.states.resize(kept);
    belief_.probabilities.resize(kept);
    for (double& probability : belief_.probabilities) probability /= sum;
    return belief_;
  }

  // The largest factor such that the weights hold this factor times the belief.
  double share_of(const Belief& belief) const {
    double share = std::numeric_limits<double>::infinity();
    std::size_t place = 0;
    for (std::size_t i = 0; i < belief.size(); ++i) {
      while (place < weighted_.size() && weighted_[place] < belief.states[i]) ++place;
      if (place == weighted_.size() || weighted_[place] != belief.states[i]) return 0;
      if (weights_[place] < share * belief.probabilities[i]) share = weights_[place] / belief.probabilities[i];
    }
    return share;
  }

 private:
  List<double> predicted_;  // by target
  List<double> dense_;      // by state; all 0 between calls
  Belief belief_;
  List<std::uint32_t> weighted_;  // the states and their weights before they were normalised
  List<double> weights_;
};

}
