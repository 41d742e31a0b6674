// Texts as UTF-8.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace aos {

// The bytes of the UTF-8 letter that a text begins with; 0 where these are none.
inline std::size_t letter_size(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned char first = byte(0);
  const std::size_t size = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  if (size > text.size()) return 0;
  for (std::size_t at = 1; at < size; ++at) {
    if ((byte(at) & 0xC0) != 0x80) return 0;
  }
  if (size < 3) return size;
  const bool is_overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool is_beyond = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  return is_overlong || is_beyond ? 0 : size;
}

// The first byte of a text that is part of no UTF-8 letter; npos where there is none.
inline std::size_t first_no_letter(std::string_view text) {
  if (std::ranges::all_of(text, [](char byte) { return static_cast<unsigned char>(byte) < 0x80; })) return std::string_view::npos;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = letter_size(text.substr(at));
    if (size == 0) return at;
    at += size;
  }
  return std::string_view::npos;
}

}
