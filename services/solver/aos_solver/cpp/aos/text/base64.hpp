// Arrays of numbers as text without line breaks. The numbers' bytes, in the order of this machine's memory,
// are encoded in base64 (RFC 4648) with padding.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "aos/base/list.hpp"

namespace aos {

namespace detail {

inline constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
inline constexpr std::uint8_t no_digit = 64;

inline constexpr std::array<std::uint8_t, 256> base64_values = [] {
  std::array<std::uint8_t, 256> values{};
  values.fill(no_digit);
  for (std::size_t value = 0; value < base64_digits.size(); ++value) {
    values[static_cast<unsigned char>(base64_digits[value])] = static_cast<std::uint8_t>(value);
  }
  return values;
}();

inline std::string base64_of(const unsigned char* bytes, std::size_t size) {
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t at = 0; at < size; at += 3) {
    const std::size_t left = size - at;
    const unsigned group = static_cast<unsigned>(bytes[at]) << 16 | (left > 1 ? static_cast<unsigned>(bytes[at + 1]) << 8 : 0) |
                           (left > 2 ? static_cast<unsigned>(bytes[at + 2]) : 0);
    text += base64_digits[group >> 18];
    text += base64_digits[group >> 12 & 63];
    text += left > 1 ? base64_digits[group >> 6 & 63] : '=';
    text += left > 2 ? base64_digits[group & 63] : '=';
  }
  return text;
}

inline std::optional<List<unsigned char>> bytes_of_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  List<unsigned char> bytes;
  bytes.reserve(text.size() * 3 / 4);
  unsigned group = 0;
  int bits = 0;
  for (const char character : text) {
    const std::uint8_t value = base64_values[static_cast<unsigned char>(character)];
    if (value == no_digit) return std::nullopt;
    group = group << 6 | value;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(group >> bits));
      group &= (1u << bits) - 1;
    }
  }
  return bytes;
}

}  // namespace detail

template <class Number>
std::string to_base64(const List<Number>& numbers) {
  static_assert(std::is_arithmetic_v<Number>);
  return detail::base64_of(reinterpret_cast<const unsigned char*>(numbers.data()), numbers.size() * sizeof(Number));
}

// Returns nothing if the text is not base64, or if its bytes do not fill a whole number of `Number`s.
template <class Number>
std::optional<List<Number>> from_base64(std::string_view text) {
  static_assert(std::is_arithmetic_v<Number>);
  const auto bytes = detail::bytes_of_base64(text);
  if (!bytes || bytes->size() % sizeof(Number) != 0) return std::nullopt;
  List<Number> numbers(bytes->size() / sizeof(Number));
  if (!bytes->empty()) std::memcpy(numbers.data(), bytes->data(), bytes->size());
  return numbers;
}

}  // namespace aos
