// The functions of the distributions that numbers are reported from. Only support.hpp includes this file.
#pragma once

#include <span>

#include "aos/draws/described_distribution.hpp"
#include "aos/draws/distributions.hpp"
#include "aos/draws/normal.hpp"

namespace aos {

[[noreturn, gnu::cold]] void bad_distribution(const char* text);

void Distribution::check() const {
  if (kind_ == Kind::normal) {
    if (!std::isfinite(first_)) bad_distribution("the mean of a reported number is not finite");
    if (!(second_ > 0) || !std::isfinite(second_)) {
      bad_distribution("the deviation of a reported number is not above 0; a number without noise has no density");
    }
  } else if (kind_ == Kind::uniform && (first_ == second_ || !std::isfinite(second_ - first_))) {
    bad_distribution("a reported number is uniform between bounds that have nothing between them");
  }
}

double Distribution::draw(Sampler& random) const {
  check();
  const std::span<const double> weights{weights_, count_};
  switch (kind_) {
    case Kind::normal: return random.SampleNormal(first_, second_);
    case Kind::uniform: return random.SampleUniform(first_, second_);
    case Kind::bernoulli: return random.flag(first_) ? 1 : 0;
    case Kind::discrete: return random.SampleDiscrete(weights);
    default: return random.SampleDiscrete(-1, weights);
  }
}

double Distribution::log_density(double value) const {
  constexpr double impossible = -std::numeric_limits<double>::infinity();
  check();
  if (kind_ == Kind::normal) return normal_log_density(value, first_, second_);
  if (kind_ == Kind::uniform) {
    const bool is_inside = std::min(first_, second_) <= value && value <= std::max(first_, second_);
    return is_inside ? -std::log(std::abs(second_ - first_)) : impossible;
  }
  if (kind_ == Kind::bernoulli) {
    const double probability = std::clamp(first_, 0.0, 1.0);
    return value == 1 ? std::log(probability) : value == 0 ? std::log1p(-probability) : impossible;
  }
  const auto [total, whole] = total_and_whole();
  if (value == -1) return std::log((whole - total) / whole);
  const bool is_index = value >= 0 && value < static_cast<double>(count_) && value == std::floor(value);
  return is_index ? std::log(weights_[static_cast<std::size_t>(value)] / whole) : impossible;
}

double Distribution::spread() const {
  return kind_ == Kind::normal ? second_ : kind_ == Kind::uniform ? 0.3 * std::abs(second_ - first_) : 0.25;
}

DescribedDistribution Distribution::described() const {
  using Described = DescribedDistribution::Kind;
  check();
  if (kind_ == Kind::normal) return {Described::normal, {first_, second_}};
  if (kind_ == Kind::uniform) return {Described::uniform, {std::min(first_, second_), std::max(first_, second_)}};
  if (kind_ == Kind::bernoulli) {
    const double probability = std::clamp(first_, 0.0, 1.0);
    return {Described::discrete, {0, 1 - probability, probability}};
  }
  const auto [total, whole] = total_and_whole();
  DescribedDistribution discrete{Described::discrete, {-1, (whole - total) / whole}};
  for (std::size_t i = 0; i < count_; ++i) discrete.numbers.push_back(weights_[i] / whole);
  return discrete;
}

std::pair<double, double> Distribution::total_and_whole() const {
  const bool is_normalised = kind_ == Kind::normalised;
  double total = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!(weights_[i] >= 0)) bad_weights("a weight is negative or not a number");
    total += weights_[i];
  }
  if (is_normalised && total <= 0) bad_weights("all weights of a draw are zero");
  return {total, is_normalised || total > 1 - weight_rounding ? total : 1};
}

}
