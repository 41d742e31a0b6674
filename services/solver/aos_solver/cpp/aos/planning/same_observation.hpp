// Elements by the observation that each has, such as the scenarios or states that a group had before a step.
#pragma once

#include <span>

#include "aos/base/stable_order.hpp"

namespace aos {

// Mostly there is only one observation, and the elements are sorted already.
template <class Element>
void sort_by_observation(List<Element>& elements, std::size_t first, std::size_t last) {
  const auto begin = elements.begin() + first;
  const auto end = elements.begin() + last;
  const auto is_before = [](const Element& left, const Element& right) { return left.observation < right.observation; };
  if (!std::is_sorted(begin, end, is_before)) sort_stably(begin, end, is_before);
}

// The end of the elements that have the observation of the one at `start`.
template <class Element>
std::size_t end_of_history(const List<Element>& elements, std::size_t start, std::size_t last) {
  std::size_t end = start + 1;
  while (end < last && elements[end].observation == elements[start].observation) ++end;
  return end;
}

// Calls `visit(first, last)` for each run of elements with the same observation.
template <class Element, class Visit>
void for_each_history(const List<Element>& elements, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < elements.size(); first = last) {
    last = end_of_history(elements, first, elements.size());
    visit(first, last);
  }
}

// Calls `visit` with the elements of each observation that so many have, and last with all others together, if there are any: a
// robot that went by so few would know what no robot can know.
template <class Element>
void for_each_group(List<Element>& elements, std::size_t fewest, auto&& visit) {
  sort_by_observation(elements, 0, elements.size());
  List<Element> rare;
  for_each_history(elements, [&](std::size_t first, std::size_t last) {
    const std::span<const Element> alike{&elements[first], last - first};
    if (alike.size() < fewest) rare.insert(rare.end(), alike.begin(), alike.end());
    else visit(alike);
  });
  if (!rare.empty()) visit(std::span<const Element>{rare});
}

}
