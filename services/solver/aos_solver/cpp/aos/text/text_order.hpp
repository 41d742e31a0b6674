// The order of texts in which numbers stand: "9;" is before "10;", as a sensor's reading of 9 is before one of 10.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>

namespace aos {

// Returns 0 if `text` is the beginning of `observed`, else a negative number if `text` is before it and a positive one if it
// is after it. Where the texts differ within numbers, the numbers decide, else the first characters that differ.
inline double order_of_texts(std::string_view text, std::string_view observed) {
  const auto differing = std::mismatch(text.begin(), text.end(), observed.begin(), observed.end()).first;
  const auto place = static_cast<std::size_t>(differing - text.begin());
  if (place == text.size()) return 0;
  constexpr std::string_view of_numbers = "+-.0123456789";
  std::size_t first = place;
  while (first > 0 && of_numbers.find(text[first - 1]) != std::string_view::npos) --first;
  const auto number_in = [&](std::string_view whole) {
    const std::string_view rest = whole.substr(first);
    return std::string{rest.substr(0, std::min(rest.find_first_not_of(of_numbers), rest.size()))};
  };
  const std::string mine = number_in(text);
  const std::string theirs = number_in(observed);
  if (!mine.empty() && !theirs.empty()) {
    const double difference = std::strtod(mine.c_str(), nullptr) - std::strtod(theirs.c_str(), nullptr);
    if (difference != 0) return difference;
  }
  return place < observed.size() && text[place] < observed[place] ? -1 : 1;
}

}
