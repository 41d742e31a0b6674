// The functions of the distributions that numbers are reported from. Included by support.hpp alone.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "aos/base/described_distribution.hpp"
#include "aos/base/distributions.hpp"
#include "aos/base/random.hpp"

namespace aos {

[[noreturn, gnu::cold]] void bad_distribution(const char* text);

namespace detail {

inline constexpr double impossible = -std::numeric_limits<double>::infinity();

}  // namespace detail

void Normal::check() const {
  if (!std::isfinite(mean_)) bad_distribution("the mean of a reported number is not finite");
  if (!(deviation_ > 0) || !std::isfinite(deviation_)) {
    bad_distribution("the deviation of a reported number is not above 0; a number without noise has no density");
  }
}
double Normal::draw(Sampler& random) const {
  check();
  return random.SampleNormal(mean_, deviation_);
}
double Normal::log_density(double value) const {
  check();
  const double distance = (value - mean_) / deviation_;
  return -0.5 * distance * distance - std::log(deviation_) - 0.5 * std::log(2 * std::numbers::pi);
}
void Normal::describe(DescribedDistribution& description) const {
  check();
  description = {DescribedDistribution::Kind::normal, {mean_, deviation_}};
}

void Uniform::check() const {
  const bool has_width = low_ != high_ && std::isfinite(high_ - low_);
  if (!has_width) bad_distribution("a reported number is uniform between bounds that have nothing between them");
}
double Uniform::draw(Sampler& random) const {
  check();
  return random.SampleUniform(low_, high_);
}
double Uniform::log_density(double value) const {
  check();
  const bool is_inside = std::min(low_, high_) <= value && value <= std::max(low_, high_);
  return is_inside ? -std::log(std::abs(high_ - low_)) : detail::impossible;
}
void Uniform::describe(DescribedDistribution& description) const {
  check();
  description = {DescribedDistribution::Kind::uniform, {std::min(low_, high_), std::max(low_, high_)}};
}

double Bernoulli::draw(Sampler& random) const { return random.flag(probability_) ? 1 : 0; }
double Bernoulli::log_density(double value) const {
  const double probability = std::clamp(probability_, 0.0, 1.0);
  if (value == 1) return std::log(probability);
  return value == 0 ? std::log1p(-probability) : detail::impossible;
}
void Bernoulli::describe(DescribedDistribution& description) const {
  const double probability = std::clamp(probability_, 0.0, 1.0);
  description = {DescribedDistribution::Kind::discrete, {0, 1 - probability, probability}};
}

double Discrete::draw(Sampler& random) const {
  const std::span<const double> weights{first_, count_};
  return is_normalised_ ? random.SampleDiscrete(-1, weights) : random.SampleDiscrete(weights);
}
std::pair<double, double> Discrete::total_and_whole() const {
  double total = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!(first_[i] >= 0)) bad_weights("a weight is negative or not a number");
    total += first_[i];
  }
  if (is_normalised_ && total <= 0) bad_weights("all weights of a draw are zero");
  return {total, is_normalised_ || total > 1 - weight_rounding ? total : 1};
}
double Discrete::log_density(double value) const {
  const auto [total, whole] = total_and_whole();
  if (value == -1) return std::log((whole - total) / whole);
  const bool is_index = value >= 0 && value < static_cast<double>(count_) && value == std::floor(value);
  return is_index ? std::log(first_[static_cast<std::size_t>(value)] / whole) : detail::impossible;
}
void Discrete::describe(DescribedDistribution& description) const {
  const auto [total, whole] = total_and_whole();
  description = {DescribedDistribution::Kind::discrete, {-1, (whole - total) / whole}};
  for (std::size_t i = 0; i < count_; ++i) description.numbers.push_back(first_[i] / whole);
}

}  // namespace aos
