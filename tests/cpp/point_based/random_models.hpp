// Small POMDPs of many kinds, each from its seed: what the point-based solver's bounds are checked on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "point_based/flat_model.hpp"

namespace truth {

using aos::point_based::FlatModel;

struct Problem {
  std::string kind;
  FlatModel model;
};

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed * 0x9e3779b97f4a7c15u + 1) {}

  Problem problem() {
    static constexpr std::array kinds{"dense", "sparse", "corridor", "tiger once", "trap", "ties"};
    const std::size_t kind = below(kinds.size());
    Problem made{kinds[kind], {}};
    switch (kind) {
      case 0: made.model = tables(1 + below(8), true); break;
      case 1: made.model = tables(2 + below(59), false); break;
      case 2: made.model = corridor(); break;
      case 3: made.model = tiger_once(); break;
      case 4: made.model = trap(); break;
      default: made.model = ties();
    }
    if (chance(0.3)) {
      made.kind += " beside a clock";
      made.model = beside_clock(made.model, 2 + below(2));
    }
    if (chance(0.25)) scale(made.model, std::pow(10.0, static_cast<double>(below(10)) - 4));
    static constexpr std::array discounts{0.8, 0.9, 0.95, 0.99, 0.999, 0.999999, 1.0};
    made.model.discount = discounts[below(discounts.size())];
    if (chance(0.5) || made.model.discount == 1) {
      static constexpr std::array<std::size_t, 8> horizons{1, 2, 3, 5, 8, 15, 40, 90};
      made.model.horizon = horizons[below(horizons.size())];
    }
    return made;
  }

  double uniform() { return std::uniform_real_distribution<double>{0, 1}(random_); }
  bool chance(double probability) { return uniform() < probability; }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>{0, count - 1}(random_); }

 private:
  using Weights = aos::List<std::pair<std::uint32_t, double>>;

  // A model under construction: rows in their order, and observations by what each next state shows.
  struct Draft {
    FlatModel model;
    Draft(std::size_t states, std::size_t actions, std::size_t observations) {
      model.states = states;
      model.actions = actions;
      model.observations = observations;
      model.outcomes.first.push_back(0);
      model.likelihoods.first.push_back(0);
    }
    std::uint32_t add_sensing(const Weights& weights) {
      for (const auto& [observation, probability] : weights) model.likelihoods.elements.push_back({observation, probability});
      model.likelihoods.first.push_back(model.likelihoods.elements.size());
      return static_cast<std::uint32_t>(model.likelihoods.first.size() - 2);
    }
    template <class SensingOf>
    void add_row(double reward, const Weights& next, SensingOf&& sensing_of) {
      model.rewards.push_back(reward);
      for (const auto& [state, probability] : next) model.outcomes.elements.push_back({state, sensing_of(state), probability});
      model.outcomes.first.push_back(model.outcomes.elements.size());
    }
  };

  // So many different numbers below `count`, with probabilities that sum to 1.
  Weights distribution(std::size_t count, std::size_t entries) {
    Weights weights;
    double total = 0;
    std::map<std::uint32_t, double> chosen;
    for (std::size_t i = 0; i < entries; ++i) {
      const double weight = chance(0.1) ? 1e-6 * uniform() : uniform();
      chosen[static_cast<std::uint32_t>(below(count))] += weight + 1e-12;
    }
    for (const auto& [number, weight] : chosen) total += weight;
    for (const auto& [number, weight] : chosen) weights.emplace_back(number, weight / total);
    return weights;
  }

  double reward() {
    if (chance(0.4)) return 0;
    if (chance(0.5)) return static_cast<double>(below(21)) - 10;
    return 20 * uniform() - 10;
  }

  FlatModel tables(std::size_t states, bool is_dense) {
    Draft draft{states, 1 + below(4), 1 + below(4)};
    FlatModel& model = draft.model;
    for (std::size_t i = 0; i < states * model.actions; ++i) {
      draft.add_sensing(distribution(model.observations, 1 + below(model.observations)));
    }
    const bool sees_by_action = chance(0.5);
    const std::size_t ended = chance(0.5) ? states - 1 : states;
    for (std::size_t state = 0; state < states; ++state) {
      for (std::size_t action = 0; action < model.actions; ++action) {
        const auto sensing = [&](std::uint32_t next) {
          return static_cast<std::uint32_t>(next * model.actions + (sees_by_action ? action : 0));
        };
        if (state == ended) {
          draft.add_row(0, {{static_cast<std::uint32_t>(state), 1}}, sensing);
        } else {
          draft.add_row(reward(), distribution(states, is_dense ? states : 1 + below(3)), sensing);
        }
      }
    }
    model.starts.push_back({1, distribution(states, 1 + below(std::min<std::size_t>(states, 5)))});
    return model;
  }

  // Cells in a line, the reward behind the last one; a noisy look tells where the robot is not.
  FlatModel corridor() {
    const auto cells = static_cast<std::uint32_t>(3 + below(28));
    Draft draft{cells + 1, 2 + below(2), 2};
    const double slip = chance(0.3) ? 0 : 0.5 * uniform();
    const double cost = chance(0.5) ? 0 : -uniform();
    const double trap = chance(0.3) ? -50 * uniform() : 0;
    for (std::uint32_t cell = 0; cell <= cells; ++cell) {
      const double share = cell % 3 == 0 ? 0.9 : chance(0.5) ? 0.5 : 0.2;
      draft.add_sensing({{0, share}, {1, 1 - share}});
    }
    const auto sensing = [](std::uint32_t next) { return next; };
    const double prize = 100 * uniform() + 1;
    const bool ends = chance(0.7);
    for (std::uint32_t cell = 0; cell <= cells; ++cell) {
      for (std::uint32_t action = 0; action < draft.model.actions; ++action) {
        if (cell == cells) {
          draft.add_row(0, {{ends ? cell : 0, 1}}, sensing);
        } else if (action == 0) {
          const bool is_last = cell + 1 == cells;
          Weights next{{cell + 1, 1 - slip}};
          if (slip > 0) next.emplace_back(cell, slip);
          draft.add_row(is_last ? (1 - slip) * prize : cost, next, sensing);
        } else if (action == 1) {
          draft.add_row(cell == 0 ? trap : cost, {{cell == 0 ? 0 : cell - 1, 1}}, sensing);
        } else {
          draft.add_row(0, {{cell, 1}}, sensing);
        }
      }
    }
    draft.model.starts.push_back({1, distribution(cells, chance(0.5) ? 1 : cells)});
    return draft.model;
  }

  FlatModel tiger_once() {
    Draft draft{3, 3, 2};
    const double accuracy = 0.55 + 0.44 * uniform();
    draft.add_sensing({{0, accuracy}, {1, 1 - accuracy}});
    draft.add_sensing({{0, 1 - accuracy}, {1, accuracy}});
    draft.add_sensing({{0, 1}});
    const auto sensing = [](std::uint32_t next) { return next; };
    const double cost = chance(0.2) ? 0 : -2 * uniform();
    for (std::uint32_t state = 0; state < 3; ++state) {
      for (std::uint32_t action = 0; action < 3; ++action) {
        if (state == 2 || action == 0) {
          draft.add_row(state == 2 ? 0 : cost, {{state, 1}}, sensing);
        } else {
          draft.add_row(action - 1 == state ? -100 : 10, {{2, 1}}, sensing);
        }
      }
    }
    draft.model.starts.push_back({1, {{0, 0.5}, {1, 0.5}}});
    return draft.model;
  }

  // One action in one state loses a thousand times what can be earned, or nearly never does.
  FlatModel trap() {
    FlatModel model = tables(2 + below(20), false);
    const std::size_t row = below(model.states * model.actions);
    model.rewards[row] = chance(0.5) ? -1e6 : -1e3;
    return model;
  }

  // Each action twice, and an action that waits.
  FlatModel ties() {
    const FlatModel from = chance(0.5) ? corridor() : tables(2 + below(10), chance(0.5));
    Draft draft{from.states, 2 * from.actions + 1, from.observations};
    draft.model.likelihoods = from.likelihoods;
    const std::uint32_t silent = draft.add_sensing({{0, 1}});
    for (std::size_t state = 0; state < from.states; ++state) {
      draft.add_row(0, {{static_cast<std::uint32_t>(state), 1}}, [&](std::uint32_t) { return silent; });
      for (std::size_t action = 0; action < draft.model.actions - 1; ++action) {
        const std::size_t row = from.row(state, action / 2);
        draft.model.rewards.push_back(from.rewards[row]);
        auto& outcomes = draft.model.outcomes;
        outcomes.elements.insert(outcomes.elements.end(), from.outcomes.begin(row), from.outcomes.end(row));
        outcomes.first.push_back(outcomes.elements.size());
      }
    }
    draft.model.starts = from.starts;
    return draft.model;
  }

  // The model with a clock that changes nothing.
  FlatModel beside_clock(const FlatModel& from, std::size_t phases) {
    const bool is_random = chance(0.5);
    const bool is_known = chance(0.5);
    Draft draft{from.states * phases, from.actions, from.observations};
    draft.model.likelihoods = from.likelihoods;
    const auto number = [&](std::size_t state, std::size_t phase) { return static_cast<std::uint32_t>(state * phases + phase); };
    for (std::size_t state = 0; state < from.states; ++state) {
      for (std::size_t phase = 0; phase < phases; ++phase) {
        for (std::size_t action = 0; action < from.actions; ++action) {
          const std::size_t row = from.row(state, action);
          draft.model.rewards.push_back(from.rewards[row]);
          for (const auto* outcome = from.outcomes.begin(row); outcome != from.outcomes.end(row); ++outcome) {
            const std::size_t next = (phase + 1) % phases;
            auto& elements = draft.model.outcomes.elements;
            const double stays = is_random ? 0.25 : 0;
            elements.push_back({number(outcome->next, next), outcome->sensing, outcome->probability * (1 - stays)});
            if (is_random) elements.push_back({number(outcome->next, phase), outcome->sensing, outcome->probability * stays});
          }
          draft.model.outcomes.first.push_back(draft.model.outcomes.elements.size());
        }
      }
    }
    draft.model.starts = {{1, {}}};
    for (const auto& [state, probability] : from.starts.front().belief) {
      for (std::size_t phase = 0; phase < (is_known ? 1 : phases); ++phase) {
        const double share = is_known ? 1 : 1 / static_cast<double>(phases);
        draft.model.starts.front().belief.emplace_back(number(state, phase), probability * share);
      }
    }
    return draft.model;
  }

  static void scale(FlatModel& model, double factor) {
    for (double& reward : model.rewards) reward *= factor;
  }

  std::mt19937_64 random_;
};

}
