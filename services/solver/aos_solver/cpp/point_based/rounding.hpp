// How far a number that was worked out may be from the number that was meant.
//
// A sum of n products is off by at most n times half an ulp of the sum of their sizes. Bounds are moved outwards by
// twice that wherever they are worked out, so that they hold as they stand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "point_based/flat_model.hpp"

namespace aos::point_based {

inline constexpr double ulp = 0x1p-52;

// Relative to the sizes in the longest sum that a model asks for, where no sum has more terms than `longest`.
inline double rounding_of(std::size_t longest) { return (static_cast<double>(longest) + 16) * ulp; }

// The most entries that any row has.
template <class Element>
std::size_t longest_row(const Rows<Element>& rows) {
  std::size_t longest = 0;
  for (std::size_t row = 0; row + 1 < rows.first.size(); ++row) {
    longest = std::max<std::size_t>(longest, rows.first[row + 1] - rows.first[row]);
  }
  return longest;
}

// For how many decisions rewards are added up, at most: a discounted mission without end is worth no more than one of
// so many decisions.
inline double lasting_decisions(const FlatModel& model) {
  if (model.horizon == 0) return 1 / (1 - model.discount);
  return std::min(static_cast<double>(model.horizon), 1 / std::max(1 - model.discount, ulp));
}

}  // namespace aos::point_based
