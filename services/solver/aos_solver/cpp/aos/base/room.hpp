// Lists that grow up to a fixed capacity and never move their elements. Their memory is reserved at once, and
// the operating system provides it as it is used. Clearing a list keeps the memory.
#pragma once

#include "aos/base/list.hpp"

namespace aos {

template <class T>
List<T> with_room_for(std::size_t capacity) {
  List<T> list;
  list.reserve(capacity);
  return list;
}

// Whether `more` further elements fit into the list.
template <class T>
bool has_room_for(const List<T>& list, std::size_t more) { return list.size() + more <= list.capacity(); }

}
