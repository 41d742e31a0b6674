// The file of the alpha vectors that a solver found. A line of JSON tells the size of each region; the rest
// is as alpha_vectors.py describes.
#pragma once

#include "aos/base/descriptor_file.hpp"
#include "aos/text/json.hpp"
#include "point_based/bounds.hpp"
#include "point_based/regions.hpp"
#include "point_based/sarsop.hpp"

namespace aos::offline {

using point_based::LowerBound;
using point_based::Region;
using point_based::Regions;
using point_based::Sarsop;

inline void write_policy(int descriptor, const Regions& regions, const Sarsop& solver) {
  DescriptorFile file{descriptor};
  const auto put = [&]<class Number>(const aos::List<Number>& numbers) {
    file.write(numbers.data(), numbers.size() * sizeof(Number));
  };
  JsonWriter sizes;
  sizes.begin_object().key("regions").begin_array();
  for (std::uint32_t number = 0; number < regions.all.size(); ++number) {
    sizes.begin_object().member("states", regions.all[number].states.size());
    sizes.member("vectors", solver.graph().lower(number).kept()).end_object();
  }
  file.write(sizes.end_array().end_object().text());
  file.write("\n");
  for (std::uint32_t number = 0; number < regions.all.size(); ++number) {
    const LowerBound& bound = solver.graph().lower(number);
    aos::List<std::uint32_t> actions;
    for (std::uint32_t i = 0; i < bound.size(); ++i) {
      if (!bound[i].is_gone()) actions.push_back(bound[i].action);
    }
    put(regions.all[number].states);
    put(actions);
    for (std::uint32_t i = 0; i < bound.size(); ++i) put(bound[i].values);
  }
  if (!file.flush()) throw std::runtime_error("the policy cannot be written");
}

}
