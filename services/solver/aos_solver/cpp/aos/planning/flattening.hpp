// A model as numbers, by the states that matter and what can be observed: what point-based search works on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/model/step.hpp"
#include "aos/model/values.hpp"
#include "aos/planning/relevant_states.hpp"
#include "point_based/flat_model.hpp"

namespace aos {

inline constexpr std::size_t most_flat_outcomes = 12'000'000;

// States in which the mission has ended are worth nothing, so outcomes that end it are left out.
template <class Model>
class Flattening {
 public:
  using State = typename Model::State;

  explicit Flattening(const RelevantStates<Model>& states) : states_(states) {}

  // Throws NotEnumerable where there is too much of it.
  point_based::FlatModel model() && {
    flat_.states = states_.size();
    flat_.actions = static_cast<std::size_t>(Model::action_count());
    flat_.discount = Model::discount;
    flat_.outcomes.first.push_back(0);
    flat_.readings.first.push_back(0);
    flat_.rewards.reserve(flat_.states * flat_.actions);
    for (std::uint32_t number = 0; number < states_.size(); ++number) {
      for (int action = 0; action < Model::action_count(); ++action) add_row(number, action);
    }
    flat_.observations = observations_.size();
    return std::move(flat_);
  }

 private:
  using SensingKey = std::vector<std::uint64_t>;  // observations with their rounded probabilities
  struct SensingHash {
    std::size_t operator()(const SensingKey& key) const {
      std::uint64_t hash = 0;
      for (const std::uint64_t part : key) hash = mixed(hash, part);
      return hash;
    }
  };

  // A path through an action that the mission goes on after.
  struct Path {
    std::uint32_t next;
    std::uint32_t observation;
    double probability;
  };

  void add_row(std::uint32_t number, int action) {
    const State& state = states_[number];
    const std::uint32_t only_next = states_.only_next(number, action);
    double reward = 0;
    paths_.clear();
    if (Model::ending(state) == Ending::running) {
      draws_.for_each_path([&](Enumerator& path) {
        State next = state;
        const Step step = Model::step(next, action, path);
        reward += path.probability() * step.reward;
        if (Model::ending(next) != Ending::running) return;
        const auto observation = static_cast<std::uint32_t>(observations_.size());
        paths_.push_back({only_next != RelevantStates<Model>::none ? only_next : states_.find(next),
                          observations_.try_emplace(step.observation, observation).first->second, path.probability()});
      });
    }
    flat_.rewards.push_back(reward);
    add_outcomes();
    flat_.outcomes.first.push_back(flat_.outcomes.elements.size());
    if (flat_.outcomes.elements.size() > most_flat_outcomes) throw NotEnumerable{"too many outcomes"};
  }

  void add_outcomes() {
    std::sort(paths_.begin(), paths_.end(), [](const Path& left, const Path& right) {
      return std::tie(left.next, left.observation) < std::tie(right.next, right.observation);
    });
    for (std::size_t first = 0; first < paths_.size();) {
      std::size_t last = first;
      double probability = 0;
      for (; last < paths_.size() && paths_[last].next == paths_[first].next; ++last) probability += paths_[last].probability;
      flat_.outcomes.elements.push_back({paths_[first].next, sensing_of(first, last, probability), probability});
      first = last;
    }
  }

  // The distribution of what is observed on paths with the same next state. Most have been met before.
  std::uint32_t sensing_of(std::size_t first, std::size_t last, double total) {
    constexpr double unit = 1e12;  // probabilities that are closer are the same
    readings_.clear();
    key_.clear();
    for (std::size_t i = first; i < last; ++i) {
      if (readings_.empty() || readings_.back().observation != paths_[i].observation) {
        readings_.push_back({paths_[i].observation, 0});
      }
      readings_.back().probability += paths_[i].probability / total;
    }
    for (const auto& [observation, probability] : readings_) {
      key_.push_back(observation);
      key_.push_back(static_cast<std::uint64_t>(std::llround(unit * probability)));
    }
    const auto [entry, is_new] = sensings_.try_emplace(key_, static_cast<std::uint32_t>(sensings_.size()));
    if (is_new) {
      flat_.readings.elements.insert(flat_.readings.elements.end(), readings_.begin(), readings_.end());
      flat_.readings.first.push_back(flat_.readings.elements.size());
    }
    return entry->second;
  }

  const RelevantStates<Model>& states_;
  point_based::FlatModel flat_;
  Enumerator draws_;
  std::unordered_map<Observation, std::uint32_t> observations_;
  std::unordered_map<SensingKey, std::uint32_t, SensingHash> sensings_;
  std::vector<Path> paths_;
  std::vector<point_based::Reading> readings_;
  SensingKey key_;
};

}  // namespace aos
