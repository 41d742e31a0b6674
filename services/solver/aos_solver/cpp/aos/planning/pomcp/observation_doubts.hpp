// What observations leave open where the state is known, and what they tell where it is not. An action is worth more by the
// mutual information of the state and its observation, at a price for each nat: then a leaf counts as if it paid the price for
// the entropy of its belief, but for a constant. What is observed is counted in the tree; noise is found from all outcomes.
#pragma once

#include "aos/base/statistics.hpp"
#include "aos/planning/pomcp/search_tree.hpp"
#include "aos/planning/values/few_outcomes.hpp"

namespace aos {

class ObservationOddsOfStep {
 public:
  void clear() { odds_.clear(); }
  void add(Observation seen, double probability) {
    const auto known = std::ranges::find(odds_, seen, &std::pair<Observation, double>::first);
    if (known != odds_.end()) known->second += probability;
    else odds_.emplace_back(seen, probability);
  }
  double entropy() const { return entropy_of(odds_, &std::pair<Observation, double>::second); }
  const List<std::pair<Observation, double>>& all() const { return odds_; }

 private:
  List<std::pair<Observation, double>> odds_;
};

template <class Model>
class ObservationDoubts {
 public:
  // The entropy of what is observed after an action in a known state, in nats. An end counts as an observation. None if the
  // action's outcomes are not few.
  std::optional<double> of(const typename Model::State& state, int action) {
    odds_.clear();
    const auto add = [&](const typename Model::State& next, const Step& step, double probability) {
      odds_.add(Model::ending(next) == Ending::running ? step.observation : no_observation, probability);
    };
    return outcomes_.visit_each(state, action, add) ? std::optional{odds_.entropy()} : std::nullopt;
  }

 private:
  FewOutcomes<Model> outcomes_;
  ObservationOddsOfStep odds_;
};

// What the observation after an action tells of the state, in nats, by the visits of its children. The entropy of few visits is
// too low, so what is noise does not tell anything. `doubt` is that of SearchTree::Told.
inline double information_of(const SearchTree& tree, const ActionNode& action, double doubt) {
  double entropy = 0;
  double going_on = 0;
  for (std::uint32_t child = action.first_child; child != no_node; child = tree.history(child).sibling) {
    const double share = static_cast<double>(tree.history(child).n) / action.n;
    entropy += share_of_entropy(share);
    going_on += share;
  }
  return std::max(entropy + share_of_entropy(1 - going_on) - doubt / action.n, 0.0);
}

}
