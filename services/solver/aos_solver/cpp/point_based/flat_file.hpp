// A POMDP as numbers in a file: what an engine writes and the offline solver reads.
//
// The file: the text "AOSFLAT1", then little-endian and without gaps
//   u64 states, actions, observations, outcomes, sensings, likelihoods, starts, start entries; f64 discount;
//   f64 rewards[states * actions]: what an action is expected to give in a state;
//   u64 first_outcome[states * actions + 1]; u32 next[outcomes]; u32 sensing[outcomes]; f64 probability[outcomes];
//   u64 first_likelihood[sensings + 1]; u32 observation[likelihoods]; f64 probability[likelihoods];
//   f64 start_weight[starts]; u64 first_entry[starts + 1]; u32 state[start entries]; f64 probability[start entries].
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "point_based/flat_model.hpp"

namespace aos::point_based {
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
  model.likelihoods.first = file.numbers<std::uint64_t>(counts[4] + 1);
  const auto observation = file.numbers<std::uint32_t>(counts[5]);
  const auto likelihood_probability = file.numbers<double>(counts[5]);
  for (std::size_t i = 0; i < observation.size(); ++i) {
    model.likelihoods.elements.push_back({observation[i], likelihood_probability[i]});
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

// Of a value for each of the elements in `rows`.
template <class Number, class Rows, class ValueOf>
void put_each(std::ofstream& file, const Rows& rows, ValueOf&& value_of) {
  for (const auto& element : rows) {
    const Number value = value_of(element);
    file.write(reinterpret_cast<const char*>(&value), sizeof value);
  }
}

// Throws std::runtime_error if the disk refuses.
inline void write_flat_model(const std::string& path, const FlatModel& model) {
  std::ofstream file{path, std::ios::binary};
  const auto put = [&](const auto& numbers) {
    put_each<typename std::decay_t<decltype(numbers)>::value_type>(file, numbers, [](const auto& number) { return number; });
  };
  std::vector<std::uint64_t> first_entry{0};
  for (const Start& start : model.starts) first_entry.push_back(first_entry.back() + start.belief.size());
  file.write("AOSFLAT1", 8);
  put(std::vector<std::uint64_t>{model.states, model.actions, model.observations, model.outcomes.elements.size(),
                                 model.likelihoods.first.size() - 1, model.likelihoods.elements.size(), model.starts.size(),
                                 first_entry.back()});
  put(std::vector<double>{model.discount});
  put(model.rewards);
  put(model.outcomes.first);
  put_each<std::uint32_t>(file, model.outcomes.elements, [](const Outcome& outcome) { return outcome.next; });
  put_each<std::uint32_t>(file, model.outcomes.elements, [](const Outcome& outcome) { return outcome.sensing; });
  put_each<double>(file, model.outcomes.elements, [](const Outcome& outcome) { return outcome.probability; });
  put(model.likelihoods.first);
  put_each<std::uint32_t>(file, model.likelihoods.elements, [](const Likelihood& likelihood) { return likelihood.observation; });
  put_each<double>(file, model.likelihoods.elements, [](const Likelihood& likelihood) { return likelihood.probability; });
  put_each<double>(file, model.starts, [](const Start& start) { return start.weight; });
  put(first_entry);
  for (const Start& start : model.starts) {
    put_each<std::uint32_t>(file, start.belief, [](const auto& entry) { return entry.first; });
  }
  for (const Start& start : model.starts) {
    put_each<double>(file, start.belief, [](const auto& entry) { return entry.second; });
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace aos::point_based
