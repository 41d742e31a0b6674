// Stable sorting with little code: elements are sorted by their places, so that the sort itself is compiled once. The standard
// library's own takes 5 kB for each type of element.
#pragma once

#include <cstdint>
#include <numeric>

#include "aos/base/function_ref.hpp"
#include "aos/base/list.hpp"

namespace aos {

// Returns the places of `count` elements in their order. Where neither of two is before the other, the first stays first.
inline List<std::uint32_t> stable_order(std::size_t count, FunctionRef<bool(std::uint32_t, std::uint32_t)> is_before) {
  List<std::uint32_t> places(count);
  std::iota(places.begin(), places.end(), std::uint32_t{0});
  std::stable_sort(places.begin(), places.end(), is_before);
  return places;
}

template <class Iterator, class IsBefore>
void sort_stably(Iterator first, Iterator last, IsBefore is_before) {
  const auto at = [first](std::uint32_t place) -> decltype(auto) { return first[static_cast<std::ptrdiff_t>(place)]; };
  const auto count = static_cast<std::size_t>(last - first);
  List<std::uint32_t> from = stable_order(count, [&](std::uint32_t one, std::uint32_t other) { return is_before(at(one), at(other)); });
  for (std::uint32_t start = 0; start < count; ++start) {
    // Around a cycle of places each element goes to its own.
    std::uint32_t to = start;
    for (; from[to] != start; to = std::exchange(from[to], to)) std::swap(at(to), at(from[to]));
    from[to] = to;
  }
}

void sort_stably(auto& elements, auto is_before) { sort_stably(elements.begin(), elements.end(), is_before); }

}
