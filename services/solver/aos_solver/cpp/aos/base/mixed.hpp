#pragma once

#include <cstdint>

namespace aos {

// A hash of what was hashed before and of one number more. No two numbers have the same hash after the same before.
inline std::uint64_t mixed(std::uint64_t hash, std::uint64_t more) {
  hash = (hash ^ more) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 32);
}

}  // namespace aos
