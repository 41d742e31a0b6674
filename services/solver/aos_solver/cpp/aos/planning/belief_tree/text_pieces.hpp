// The pieces of a response's text by number, for tables of how often each is written.
//
// A piece that is a number, as in "12.5 ", may have more values than runs of the model can show. Such numbers fall into
// cells of half a standard deviation. What is told apart less is worth less, so plans do not promise too much by it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/planning/belief_tree/belief_tree_constants.hpp"

namespace aos {

class TextPieces {
 public:
  // The number of a piece. Numbers of one skill in equal surroundings are in one cell if they are close.
  std::uint32_t symbol(int skill, const std::string& piece) {
    const Parsed parsed = parsed_of(skill, piece);
    const double width = parsed.is_number ? widths_[parsed.surroundings] : 0;
    if (!(width > 0)) return number_of(std::to_string(skill) + "=" + piece);
    return number_of(parsed.surroundings + "#" + std::to_string(std::llround(parsed.value / width)));
  }

  // Looks at what has been written in one place. Returns whether cells have become new or smaller.
  bool adapt(int skill, const std::vector<const std::string*>& pieces) {
    std::unordered_map<std::string, std::vector<double>> values;
    for (const std::string* piece : pieces) {
      if (const Parsed parsed = parsed_of(skill, *piece); parsed.is_number) values[parsed.surroundings].push_back(parsed.value);
    }
    bool has_changed = false;
    for (auto& [surroundings, drawn] : values) has_changed = adapt(widths_[surroundings], drawn) || has_changed;
    return has_changed;
  }

 private:
  struct Parsed {
    bool is_number;
    std::string surroundings;
    double value;
  };

  static Parsed parsed_of(int skill, const std::string& piece) {
    const std::size_t digit = piece.find_first_of("0123456789");
    if (digit == std::string::npos) return {false, {}, 0};
    std::size_t from = digit;
    if (from > 0 && piece[from - 1] == '.') --from;
    if (from > 0 && piece[from - 1] == '-') --from;
    char* end = nullptr;
    const double value = std::strtod(piece.c_str() + from, &end);
    return {std::isfinite(value), std::to_string(skill) + ":" + piece.substr(0, from) + "#" + end, value};
  }

  // Cells are made where most values differ, and made smaller where the values of another place lie closer together.
  static bool adapt(double& width, std::vector<double>& drawn) {
    std::sort(drawn.begin(), drawn.end());
    const auto count = static_cast<double>(drawn.size());
    double mean = 0;
    double different = 1;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      mean += drawn[i] / count;
      different += i > 0 && drawn[i] != drawn[i - 1];
    }
    if (different < many_values) return false;
    double squares = 0;
    for (const double value : drawn) squares += (value - mean) * (value - mean);
    const double wanted = std::sqrt(squares / count) / 2;
    if (width > 0 && wanted > width / 2) return false;
    width = wanted;
    return true;
  }

  std::uint32_t number_of(const std::string& text) {
    return numbers_.try_emplace(text, static_cast<std::uint32_t>(numbers_.size())).first->second;
  }

  std::unordered_map<std::string, double> widths_;  // 0: each value is a symbol of its own
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace aos
