// How far a computed number may be from the exact one.
//
// A sum of n products is off by at most n times half an ulp of the sum of their absolute values. Each
// computed bound is moved outwards by twice that, so that it holds in spite of rounding.
#pragma once

#include "point_based/flat_model.hpp"

namespace aos::point_based {

inline constexpr double ulp = 0x1p-52;

// The error of a sum of at most `longest` terms, relative to the sum of their absolute values.
inline double rounding_of(std::size_t longest) { return (static_cast<double>(longest) + 16) * ulp; }

// The number of elements of the longest row.
template <class Element>
std::size_t longest_row(const Rows<Element>& rows) {
  std::size_t longest = 0;
  for (std::size_t row = 0; row + 1 < rows.first.size(); ++row) {
    longest = std::max<std::size_t>(longest, rows.first[row + 1] - rows.first[row]);
  }
  return longest;
}

// Over how many decisions rewards add up, at most. A discounted mission without end is worth no more than an
// undiscounted one of this many decisions.
inline double lasting_decisions(const FlatModel& model) {
  if (model.horizon == 0) return 1 / (1 - model.discount);
  return std::min(static_cast<double>(model.horizon), 1 / std::max(1 - model.discount, ulp));
}

}
