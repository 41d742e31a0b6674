// A POMDP as numbers in a file. An engine writes the file, and the offline solver reads it.
//
// The file: the text "AOSFLAT1", then little-endian
//   u64 states, actions, observations, outcomes, sensings, likelihoods, starts, start entries; f64 discount;
//   f64 rewards[states * actions]: what an action is expected to give in a state;
//   u64 first_outcome[states * actions + 1]; {u32 next, u32 sensing, f64 probability}[outcomes];
//   u64 first_likelihood[sensings + 1]; {u32 observation, u32 unused, f64 probability}[likelihoods];
//   f64 start_weight[starts]; u64 first_entry[starts + 1]; {u32 state, u32 unused, f64 probability}[start entries].
#pragma once

#include <fstream>
#include <stdexcept>
#include <string>

#include "aos/base/descriptor_file.hpp"
#include "point_based/flat_model.hpp"

namespace aos::point_based {
namespace detail {

struct Entry {
  std::uint32_t state;
  std::uint32_t unused;
  double probability;
};
static_assert(sizeof(Entry) == 16 && sizeof(Outcome) == 16 && sizeof(Likelihood) == 16);

template <class Number>
List<Number> numbers(std::ifstream& file, std::size_t count) {
  List<Number> read(count);
  if (!file.read(reinterpret_cast<char*>(read.data()), static_cast<std::streamsize>(count * sizeof(Number)))) {
    throw std::runtime_error("the flat model ends too early");
  }
  return read;
}

}  // namespace detail

// Throws std::runtime_error if the file is not there, no flat model, or too short.
inline FlatModel read_flat_model(const std::string& path) {
  std::ifstream file{path, std::ios::binary};
  char mark[8];
  if (!file.read(mark, sizeof mark) || std::memcmp(mark, "AOSFLAT1", sizeof mark) != 0) {
    throw std::runtime_error("not a flat model: " + path);
  }
  const auto counts = detail::numbers<std::uint64_t>(file, 8);
  FlatModel model;
  model.states = counts[0];
  model.actions = counts[1];
  model.observations = counts[2];
  model.discount = detail::numbers<double>(file, 1)[0];
  model.rewards = detail::numbers<double>(file, model.states * model.actions);
  model.outcomes.first = detail::numbers<std::uint64_t>(file, model.states * model.actions + 1);
  model.outcomes.elements = detail::numbers<Outcome>(file, counts[3]);
  model.likelihoods.first = detail::numbers<std::uint64_t>(file, counts[4] + 1);
  model.likelihoods.elements = detail::numbers<Likelihood>(file, counts[5]);
  const auto weights = detail::numbers<double>(file, counts[6]);
  const auto first_entry = detail::numbers<std::uint64_t>(file, counts[6] + 1);
  const auto entries = detail::numbers<detail::Entry>(file, counts[7]);
  for (std::size_t start = 0; start < weights.size(); ++start) {
    model.starts.push_back({weights[start], {}});
    for (std::uint64_t i = first_entry[start]; i < first_entry[start + 1]; ++i) {
      model.starts.back().belief.emplace_back(entries[i].state, entries[i].probability);
    }
  }
  return model;
}

inline void write_flat_model(DescriptorFile& file, const FlatModel& model) {
  const auto put = [&]<class Number>(const List<Number>& numbers) {
    file.write(numbers.data(), numbers.size() * sizeof(Number));
  };
  List<double> weights;
  List<std::uint64_t> first_entry{0};
  List<detail::Entry> entries;
  for (const auto& [weight, belief] : model.starts) {
    weights.push_back(weight);
    for (const auto& [state, probability] : belief) entries.push_back({state, 0, probability});
    first_entry.push_back(entries.size());
  }
  file.write("AOSFLAT1");
  put(List<std::uint64_t>{model.states, model.actions, model.observations, model.outcomes.elements.size(),
                                 model.likelihoods.first.size() - 1, model.likelihoods.elements.size(), weights.size(),
                                 entries.size()});
  put(List<double>{model.discount});
  put(model.rewards);
  put(model.outcomes.first);
  put(model.outcomes.elements);
  put(model.likelihoods.first);
  put(model.likelihoods.elements);
  put(weights);
  put(first_entry);
  put(entries);
}

}  // namespace aos::point_based
