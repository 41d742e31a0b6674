// Lists that grow up to a fixed capacity without ever moving their elements. Memory is reserved at once and, as operating
// systems do it, taken as it is used; clearing a list keeps it.
#pragma once

#include <cstddef>
#include <vector>

namespace aos {

template <class T>
std::vector<T> with_room_for(std::size_t capacity) {
  std::vector<T> list;
  list.reserve(capacity);
  return list;
}

// Whether so many more elements fit in.
template <class T>
bool has_room_for(const std::vector<T>& list, std::size_t more) {
  return list.size() + more <= list.capacity();
}

}  // namespace aos
