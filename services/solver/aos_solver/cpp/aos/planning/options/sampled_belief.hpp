// A few states of a belief that stand for it, with weights, and what observations make of the weights.
#pragma once

#include <map>
#include <unordered_map>

#include "aos/base/function_ref.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

using StateWeights = List<double>;  // by state; they sum to 1

inline constexpr int drawn_observations = 16;  // where not all can be listed

// Calls `use` with the numbers of so many states, drawn at even distances in the weights.
inline void draw_states(const StateWeights& weights, int count, Sampler& random, FunctionRef<void(std::size_t)> use) {
  double place = random.uniform() / count;
  double below = 0;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i, place += 1.0 / count) {
    while (k + 1 < weights.size() && below + weights[k] <= place) below += weights[k++];
    use(k);
  }
}

// Bayes' rule, given what a step from each state may report. Weights that an observation leaves nothing of stay.
inline void observe(const List<StepReports>& reports, const Seen& seen, StateWeights& weights) {
  StateWeights after = weights;
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (after[k] > 0) after[k] *= reports[k].likelihood(seen);
    sum += after[k];
  }
  if (!(sum > 0)) return;
  for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = after[k] / sum;
}

// The mutual information of the state and what is observed, in nats; estimated from drawn observations where not all can be listed.
inline double information(const StateWeights& weights, const List<StepReports>& reports, Sampler& random) {
  const auto told = [&](const Seen& seen, std::size_t k) { return weights[k] > 0 ? reports[k].likelihood(seen) : 0; };
  const List<Observation> responses = few_responses(reports);
  double sum = 0;
  for (const Observation response : responses) {
    double all = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const double own = told({response, {}}, k);
      all += weights[k] * own;
      if (own > 0) sum += weights[k] * own * std::log(own);
    }
    if (all > 0) sum -= all * std::log(all);
  }
  if (!responses.empty()) return sum;
  draw_states(weights, drawn_observations, random, [&](std::size_t k) {
    const Seen seen = reports[k].drawn(random);
    double all = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) all += weights[i] * told(seen, i);
    const double own = told(seen, k);
    if (own > 0 && all > 0) sum += std::log(own / all);
  });
  return sum / drawn_observations;
}

template <class Model>
class SampledBelief {
 public:
  using State = typename Model::State;

  // Draws at most `count` states of the running part, which is not empty. Equal ones are one.
  void draw(const Belief<Model>& belief, std::size_t count, Sampler& random) {
    Gathering<Model> gathering;
    draw_evenly<Model>(belief.particles(), count, random, [&](const State& state) {
      if (Model::ending(state) == Ending::running) gathering.add(state, 1);
    });
    for (auto next = belief.particles().begin(); gathering.size() == 0; ++next) {
      if (Model::ending(next->state) == Ending::running) gathering.add(next->state, 1);
    }
    states_.clear();
    weights_.clear();
    for (const auto& [state, weight] : gathering.particles()) {
      states_.push_back(state);
      weights_.push_back(weight / gathering.total());
    }
  }

  // Takes the running part, which is not empty, with one state for all of the same key, and leaves at most `count` of these. Of
  // many particles a part is drawn: to compare 100,000 takes half of a budget of 0.1 s.
  void draw_alike(const Belief<Model>& belief, std::size_t count, FunctionRef<std::uint64_t(const State&)> key_of, Sampler& random) {
    std::unordered_map<std::uint64_t, std::size_t> known;
    List<State> alike;
    StateWeights weights;
    const auto take = [&](const State& state, double weight) {
      if (Model::ending(state) != Ending::running) return;
      const auto [entry, is_new] = known.emplace(key_of(state), alike.size());
      if (is_new) alike.push_back(state);
      if (is_new) weights.push_back(0);
      weights[entry->second] += weight;
    };
    const auto& particles = belief.particles();
    if (particles.size() > most_compared) draw_evenly<Model>(particles, most_compared, random, [&](const State& state) { take(state, 1); });
    if (alike.empty()) {
      for (const auto& [state, weight] : particles) take(state, weight);
    }
    thin_out(weights, count, random);
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    states_.clear();
    weights_.clear();
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] <= 0) continue;
      states_.push_back(alike[k]);
      weights_.push_back(weights[k] / total);
    }
  }

  // Weighs the states so that each variable of few values is distributed as in the whole belief (raking: Deming and Stephan, 1940), as long
  // as the weights stay even enough. What is drawn of a dozen things errs in each, and of many options the draw flatters the best one.
  // What runs down, which `set_back(state)` undoes, does not count: one state stands for all that differ only in that.
  void rake(const Belief<Model>& belief, const auto& cells, FunctionRef<void(State&)> set_back, Sampler& random) {
    const std::size_t variables = cells.size();
    List<std::uint64_t> row(variables);
    List<std::map<std::uint64_t, double>> shares(variables);  // of the belief, by the values that the states have
    List<std::uint64_t> rows;
    List<std::uint64_t> before(variables);
    std::vector<bool> runs_down(variables);
    for (const State& state : states_) {
      cells.write(state, row.data());
      rows.insert(rows.end(), row.begin(), row.end());
      State earlier = state;
      set_back(earlier);
      cells.write(earlier, before.data());
      for (std::size_t v = 0; v < variables; ++v) {
        shares[v].emplace(row[v], 0.0);
        if (row[v] != before[v]) runs_down[v] = true;
      }
    }
    const auto is_raked = [&](std::size_t v) { return !runs_down[v] && shares[v].size() > 1 && shares[v].size() <= most_values; };
    const int drawn = static_cast<int>(raked_cells / (variables + 1));
    draw_evenly<Model>(belief.particles(), drawn, random, [&](const State& state) {
      if (Model::ending(state) != Ending::running) return;
      cells.write(state, row.data());
      for (std::size_t v = 0; v < variables; ++v) {
        const auto known = is_raked(v) ? shares[v].find(row[v]) : shares[v].end();
        if (known != shares[v].end()) known->second += 1;
      }
    });
    StateWeights raked = weights_;
    const double least = evenness(weights_) / 2;
    for (std::size_t turn = 0; turn < sweeps * variables; ++turn) {
      const std::size_t v = turn % variables;
      if (!is_raked(v)) continue;
      std::map<std::uint64_t, double> sums;
      for (std::size_t k = 0; k < raked.size(); ++k) sums[rows[k * variables + v]] += raked[k];
      double total = 0;
      for (std::size_t k = 0; k < raked.size(); ++k) {
        const std::uint64_t value = rows[k * variables + v];
        raked[k] *= raked[k] > 0 ? shares[v].at(value) / sums.at(value) : 0;
        total += raked[k];
      }
      if (!(total > 0)) return;
      for (double& weight : raked) weight /= total;
      if (evenness(raked) < least) return;
      weights_ = raked;
    }
  }

  std::size_t size() const { return states_.size(); }
  const List<State>& states() const { return states_; }
  const StateWeights& weights() const { return weights_; }
  // The mean of a number `of(k)` of each state.
  double mean(auto&& of) const {
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k) sum += weights_[k] * of(k);
    return sum;
  }

 private:
  static constexpr std::size_t most_compared = 8192;   // particles
  static constexpr std::size_t most_values = 8;        // of a variable that is raked
  static constexpr std::size_t raked_cells = 100'000;  // of the belief
  static constexpr std::size_t sweeps = 8;

  // How many states of even weight are as good.
  static double evenness(const StateWeights& weights) { return 1 / std::inner_product(weights.begin(), weights.end(), weights.begin(), 0.0); }

  List<State> states_;
  StateWeights weights_;
};

}
