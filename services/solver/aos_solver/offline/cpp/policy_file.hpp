// The alpha vectors that were found, as a file.
//
// The text "AOSALPH1", then little-endian and without gaps u64 regions, states, vectors; u64 first_state[regions + 1];
// u32 states[states], those of one region after those of another; and for every vector u32 region, u32 action,
// f64 values[states of the region].
#pragma once

#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "point_based/bounds.hpp"
#include "point_based/regions.hpp"
#include "point_based/sarsop.hpp"

namespace aos::offline {

using point_based::LowerBound;
using point_based::Region;
using point_based::Regions;
using point_based::Sarsop;

inline void write_policy(const std::string& path, const Regions& regions, const Sarsop& solver) {
  std::ofstream file{path, std::ios::binary};
  const auto put = [&](const auto* first, std::size_t count) {
    file.write(reinterpret_cast<const char*>(first), static_cast<std::streamsize>(count * sizeof *first));
  };
  std::vector<std::uint64_t> first_state{0};
  for (const Region& region : regions.all) first_state.push_back(first_state.back() + region.states.size());
  const std::uint64_t counts[] = {regions.all.size(), first_state.back(), solver.vectors()};
  put("AOSALPH1", 8);
  put(counts, 3);
  put(first_state.data(), first_state.size());
  for (const Region& region : regions.all) put(region.states.data(), region.states.size());
  for (std::uint32_t number = 0; number < regions.all.size(); ++number) {
    const LowerBound& bound = solver.lower_of(number);
    for (std::uint32_t i = 0; i < bound.size(); ++i) {
      if (bound[i].is_gone()) continue;
      const std::uint32_t head[] = {number, bound[i].action};
      put(head, 2);
      put(bound[i].values.data(), bound[i].values.size());
    }
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace aos::offline
