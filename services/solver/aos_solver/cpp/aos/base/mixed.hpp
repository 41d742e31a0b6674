#pragma once

#include <cstdint>

#include "aos/base/list.hpp"

namespace aos {

// Extends a hash by one number. With the same `hash`, different numbers give different results.
inline std::uint64_t mixed(std::uint64_t hash, std::uint64_t more) {
  hash = (hash ^ more) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 32);
}

struct NumbersHash {
  std::size_t operator()(const List<std::uint64_t>& numbers) const {
    std::uint64_t hash = 0;
    for (const std::uint64_t number : numbers) hash = mixed(hash, number);
    return hash;
  }
};

}
