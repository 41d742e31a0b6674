// A distribution of a reported number, described by its parameters. The description suffices to compare
// distributions and to compute the probability that a draw falls into an interval.
#pragma once

#include "aos/draws/normal.hpp"
#include "aos/draws/random.hpp"

namespace aos {

struct DescribedDistribution {
  enum class Kind : std::uint8_t { normal, uniform, discrete };

  Kind kind = Kind::normal;
  // Normal: mean and deviation. Uniform: lower and upper bound. Discrete: the first value, then the
  // probabilities of this value and of those that follow in steps of 1.
  List<double> numbers{};

  bool operator==(const DescribedDistribution&) const = default;

  // The probability that a draw is less than `value`, with an error below 1e-15.
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

  // The logarithm of the density; of a discrete distribution, of the probability.
  double log_density(double value) const {
    constexpr double never = -std::numeric_limits<double>::infinity();
    switch (kind) {
      case Kind::normal: return normal_log_density(value, numbers[0], numbers[1]);
      case Kind::uniform:
        return value >= numbers[0] && value <= numbers[1] ? -std::log(numbers[1] - numbers[0]) : never;
      default: break;
    }
    const double place = value - numbers[0];
    const bool is_known = place >= 0 && place + 1 < static_cast<double>(numbers.size());
    return is_known ? std::log(numbers[static_cast<std::size_t>(place) + 1]) : never;
  }

  // The value below which a draw lies with a probability, which is at least 0 and below 1.
  double quantile(double probability) const {
    switch (kind) {
      case Kind::normal: return numbers[0] + numbers[1] * normal_quantile(probability + 0x1p-54);
      case Kind::uniform: return numbers[0] + (numbers[1] - numbers[0]) * probability;
      default: break;
    }
    const int count = static_cast<int>(numbers.size()) - 1;
    return numbers[0] + place_in(numbers.data() + 1, count, probability);
  }

  // Appends values that part the draws into pieces. A piece is half a deviation of a normal distribution, an
  // eighth of a uniform one, or one value of a discrete one.
  void add_edges(List<double>& edges) const {
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

}
