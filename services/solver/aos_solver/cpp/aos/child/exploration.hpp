// The whole model as numbers, piece by piece: every outcome of every action in every state that can be reached.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/json.hpp"
#include "aos/belief/belief.hpp"
#include "aos/child/left_out.hpp"

namespace aos {

// States are numbered in the order of discovery, those of the belief first. States that have ended get no number: what
// leads to one leads to -1. Those that differ only in what is left out have one number.
template <class Model>
class Exploration {
 public:
  using State = typename Model::State;

  // Throws NotEnumerable.
  Exploration(const Belief<Model>& belief, LeftOut<Model> left_out) : left_out_(std::move(left_out)) {
    if (!belief.is_exact()) throw NotEnumerable{"the initial belief is only known by samples"};
    for (const auto& particle : belief.particles()) number_of(particle.state);
  }

  // Goes on for about so long and tells what is new: the texts of states and observations; for each explored state its
  // expected rewards and numbers of outcomes, by action; and the outcomes. Throws NotEnumerable.
  template <class ResponseText>
  void go_on(JsonWriter& json, double seconds, ResponseText&& response_text) {
    const std::chrono::duration<double> allowed{seconds};
    const auto latest = Clock::now() + std::chrono::duration_cast<Clock::duration>(allowed);
    rewards_.clear();
    counts_.clear();
    outcomes_.clear();
    while (explored_ < states_.size() && outcomes_.size() < most_told && Clock::now() < latest) {
      for (int action = 0; action < Model::action_count(); ++action) explore(explored_, action, response_text);
      ++explored_;
    }
    tell(json);
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Outcome {
    std::int64_t next;
    std::size_t observation;
    double probability;
  };
  struct Hash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };

  static constexpr std::size_t most_told = 200'000;

  std::int64_t number_of(const State& state) {
    if (Model::ending(state) != Ending::running) return -1;
    const auto number = static_cast<std::int64_t>(states_.size());
    const auto [entry, is_new] = numbers_.try_emplace(left_out_.rest_of(state), number);
    if (is_new) states_.push_back(&entry->first);
    return entry->second;
  }

  template <class ResponseText>
  void explore(std::size_t number, int action, ResponseText&& response_text) {
    const std::size_t first = outcomes_.size();
    double reward = 0;
    draws_.for_each_path([&](Enumerator& path) {
      State next = *states_[number];
      const Step step = Model::step(next, action, path);
      reward += path.probability() * step.reward;
      const std::size_t observation = observation_number(Model::skill_of(action), step.observation, [&] {
        return std::string{response_text(action, step.observation)};
      });
      outcomes_.push_back({number_of(next), observation, path.probability()});
    });
    merge(first);
    rewards_.push_back(reward);
    counts_.push_back(outcomes_.size() - first);
  }

  // Equal outcomes of one action become one.
  void merge(std::size_t first) {
    const auto from = outcomes_.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(from, outcomes_.end(), [](const Outcome& left, const Outcome& right) {
      return std::tie(left.next, left.observation) < std::tie(right.next, right.observation);
    });
    auto kept = from;
    for (auto outcome = from; outcome != outcomes_.end(); ++outcome) {
      if (kept != from && (kept - 1)->next == outcome->next && (kept - 1)->observation == outcome->observation) {
        (kept - 1)->probability += outcome->probability;
      } else {
        *kept++ = *outcome;
      }
    }
    outcomes_.erase(kept, outcomes_.end());
  }

  // Skills may share the text of a response: to the robot it is the same observation.
  template <class Text>
  std::size_t observation_number(int skill, Observation observation, Text&& text) {
    const auto known = observation_numbers_.find({skill, observation});
    if (known != observation_numbers_.end()) return known->second;
    const auto [named, is_new] = named_.try_emplace(text(), observations_.size());
    if (is_new) observations_.push_back(named->first);
    observation_numbers_[{skill, observation}] = named->second;
    return named->second;
  }

  void tell(JsonWriter& json) {
    json.begin_object().member("explored", explored_).key("states").begin_array();
    for (; told_states_ < states_.size(); ++told_states_) json.value(Model::save_state(*states_[told_states_]));
    json.end_array().key("observations").begin_array();
    for (; told_observations_ < observations_.size(); ++told_observations_) {
      json.value(observations_[told_observations_]);
    }
    json.end_array().key("rewards").begin_array();
    for (const double reward : rewards_) json.value(reward);
    json.end_array().key("counts").begin_array();
    for (const std::size_t count : counts_) json.value(count);
    json.end_array().key("outcomes").begin_array();
    for (const Outcome& outcome : outcomes_) {
      json.begin_array().value(outcome.next).value(outcome.observation).value(outcome.probability).end_array();
    }
    json.end_array().end_object();
  }

  LeftOut<Model> left_out_;
  Enumerator draws_;
  std::unordered_map<State, std::int64_t, Hash> numbers_;
  std::vector<const State*> states_;  // elements of `numbers_`, which stay where they are
  std::map<std::pair<int, Observation>, std::size_t> observation_numbers_;
  std::unordered_map<std::string, std::size_t> named_;
  std::vector<std::string> observations_;
  std::size_t explored_ = 0;
  std::size_t told_states_ = 0;
  std::size_t told_observations_ = 0;
  std::vector<double> rewards_;
  std::vector<std::size_t> counts_;
  std::vector<Outcome> outcomes_;
};

}  // namespace aos
