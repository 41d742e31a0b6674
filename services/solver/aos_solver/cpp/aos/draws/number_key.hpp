// The names of the numbers that a robot observes besides a response.
#pragma once

#include <cstdint>

namespace aos {

// Names a number of a skill: the index of its name and, where the name stands for an array, the index in it.
using NumberKey = std::uint32_t;
inline constexpr int number_index_bits = 16;
inline constexpr NumberKey number_key(std::uint32_t name, std::uint32_t index) { return name << number_index_bits | index; }
inline constexpr std::uint32_t name_of_number(NumberKey key) { return key >> number_index_bits; }
inline constexpr std::uint32_t index_of_number(NumberKey key) { return key & ((1u << number_index_bits) - 1); }

}
