// A distribution of reported numbers by its own numbers: what it takes to tell it from others, and to work out how
// likely its draws are to fall somewhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

namespace aos {

struct DescribedDistribution {
  enum class Kind : std::uint8_t { normal, uniform, discrete };

  Kind kind = Kind::normal;
  // Mean and deviation; the lower and the upper bound; or the first value, with the probabilities of it and of the next.
  std::vector<double> numbers{};

  bool operator==(const DescribedDistribution&) const = default;

  // The probability of a draw that is less; right to 1e-15.
  double below(double value) const {
    switch (kind) {
      case Kind::normal: return 0.5 * std::erfc((numbers[0] - value) / (numbers[1] * std::numbers::sqrt2));
      case Kind::uniform: return std::clamp((value - numbers[0]) / (numbers[1] - numbers[0]), 0.0, 1.0);
      default: break;
    }
    double sum = 0;
    const auto value_of = [&](std::size_t place) { return numbers[0] + static_cast<double>(place - 1); };
    for (std::size_t i = 1; i < numbers.size() && value_of(i) < value; ++i) sum += numbers[i];
    return std::min(sum, 1.0);
  }

  // Values that part its draws into pieces, none of which is much likelier than half a deviation's.
  void add_edges(std::vector<double>& edges) const {
    constexpr int parts = 4;
    switch (kind) {
      case Kind::normal:
        for (int i = -2 * parts; i <= 2 * parts; ++i) edges.push_back(numbers[0] + 0.5 * i * numbers[1]);
        return;
      case Kind::uniform:
        for (int i = 0; i <= 2 * parts; ++i) edges.push_back(numbers[0] + (numbers[1] - numbers[0]) * i / (2 * parts));
        return;
      case Kind::discrete:
        for (std::size_t i = 2; i < numbers.size(); ++i) edges.push_back(numbers[0] + static_cast<double>(i) - 1.5);
        return;
    }
  }
};

}  // namespace aos
