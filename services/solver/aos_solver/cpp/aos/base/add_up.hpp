// Elements with weights, of which those with the same key become one.
#pragma once

#include "aos/base/list.hpp"

namespace aos {

// Leaves one of neighbours with the same `key`, with the sum of their weights.
template <class Element, class Key>
void add_up_neighbours(List<Element>& elements, Key Element::*key, double Element::*weight) {
  std::size_t kept = 0;
  for (const Element& element : elements) {
    if (kept > 0 && elements[kept - 1].*key == element.*key) elements[kept - 1].*weight += element.*weight;
    else elements[kept++] = element;
  }
  elements.erase(elements.begin() + static_cast<std::ptrdiff_t>(kept), elements.end());
}

}
