// A POMDP as numbers in a file: what the offline solver reads.
//
// The file: the text "AOSFLAT1", then little-endian and without gaps
//   u64 states, actions, observations, outcomes, sensings, readings, starts, start entries; f64 discount;
//   f64 rewards[states * actions]: what an action is expected to give in a state;
//   u64 first_outcome[states * actions + 1]; u32 next[outcomes]; u32 sensing[outcomes]; f64 probability[outcomes];
//   u64 first_reading[sensings + 1]; u32 observation[readings]; f64 probability[readings];
//   f64 start_weight[starts]; u64 first_entry[starts + 1]; u32 state[start entries]; f64 probability[start entries].
#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "point_based/flat_model.hpp"

namespace aos::offline {

using point_based::FlatModel;

namespace detail {

class FlatFile {
 public:
  explicit FlatFile(const std::string& path) : file_(path, std::ios::binary) {
    char mark[8];
    if (!file_.read(mark, sizeof mark) || std::memcmp(mark, "AOSFLAT1", sizeof mark) != 0) {
      throw std::runtime_error("not a flat model: " + path);
    }
  }

  template <class Number>
  std::vector<Number> numbers(std::size_t count) {
    std::vector<Number> read(count);
    if (!file_.read(reinterpret_cast<char*>(read.data()), static_cast<std::streamsize>(count * sizeof(Number)))) {
      throw std::runtime_error("the flat model ends too early");
    }
    return read;
  }

 private:
  std::ifstream file_;
};

}  // namespace detail

inline FlatModel read_flat_model(const std::string& path) {
  detail::FlatFile file{path};
  const auto counts = file.numbers<std::uint64_t>(8);
  FlatModel model;
  model.states = counts[0];
  model.actions = counts[1];
  model.observations = counts[2];
  model.discount = file.numbers<double>(1)[0];
  model.rewards = file.numbers<double>(model.states * model.actions);
  model.outcomes.first = file.numbers<std::uint64_t>(model.states * model.actions + 1);
  const auto next = file.numbers<std::uint32_t>(counts[3]);
  const auto sensing = file.numbers<std::uint32_t>(counts[3]);
  const auto outcome_probability = file.numbers<double>(counts[3]);
  for (std::size_t i = 0; i < next.size(); ++i) {
    model.outcomes.elements.push_back({next[i], sensing[i], outcome_probability[i]});
  }
  model.readings.first = file.numbers<std::uint64_t>(counts[4] + 1);
  const auto observation = file.numbers<std::uint32_t>(counts[5]);
  const auto reading_probability = file.numbers<double>(counts[5]);
  for (std::size_t i = 0; i < observation.size(); ++i) {
    model.readings.elements.push_back({observation[i], reading_probability[i]});
  }
  const auto weights = file.numbers<double>(counts[6]);
  const auto first_entry = file.numbers<std::uint64_t>(counts[6] + 1);
  const auto state = file.numbers<std::uint32_t>(counts[7]);
  const auto probability = file.numbers<double>(counts[7]);
  for (std::size_t start = 0; start < weights.size(); ++start) {
    model.starts.push_back({weights[start], {}});
    for (std::uint64_t i = first_entry[start]; i < first_entry[start + 1]; ++i) {
      model.starts.back().belief.emplace_back(state[i], probability[i]);
    }
  }
  return model;
}

}  // namespace aos::offline
