// How many states there are at least once those are taken together that no experiment can tell apart.
#pragma once

#include "aos/base/list.hpp"
#include "flat.hpp"

namespace exam {

// The running states that can be reached from a belief, by the coarsest partition whose states earn the same, lead to
// the same parts by the same observations. Whoever takes fewer apart, changes the model.
inline std::size_t told_apart(const Flat& flat, const Mass& from) {
  aos::List<char> is_reached(flat.states(), 0);
  aos::List<std::uint32_t> found;
  const auto reach = [&](std::uint32_t state) {
    if (!is_reached[state]) found.push_back(state);
    is_reached[state] = 1;
  };
  for (const auto& entry : from) reach(entry.first);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t action = 0; action < flat.actions(); ++action) {
      for (const Branch& branch : flat.branches(found[i], action)) reach(branch.next);
    }
  }
  aos::List<std::uint32_t> part(flat.states(), 0);
  for (std::size_t parts = 1;;) {
    std::map<aos::List<std::int64_t>, std::uint32_t> signatures;
    aos::List<std::uint32_t> next(flat.states(), 0);
    for (const std::uint32_t state : found) {
      aos::List<std::int64_t> signature{part[state]};
      for (std::size_t action = 0; action < flat.actions(); ++action) {
        std::map<std::pair<int, std::uint32_t>, double> leads_to;
        for (const Branch& branch : flat.branches(state, action)) {
          leads_to[{branch.observation, part[branch.next]}] += branch.probability;
        }
        signature.push_back(std::llround(1e6 * flat.reward(state, action)));
        for (const auto& [key, probability] : leads_to) {
          signature.push_back(key.first);
          signature.push_back(key.second);
          signature.push_back(std::llround(1e6 * probability));
        }
        signature.push_back(-1);
      }
      next[state] = signatures.try_emplace(signature, static_cast<std::uint32_t>(signatures.size())).first->second;
    }
    part.swap(next);
    if (signatures.size() == parts) return parts;
    parts = signatures.size();
  }
}

}
