// The distributions that model code may report a number from. A distribution draws values and gives their
// density. The density of a finite distribution is the probability of the value.
//
// Few simulations want the numbers of their steps, so most distributions are made and never used. Their
// constructors are cheap and check nothing. A bad parameter raises a ModelFault at the first use.
#pragma once

#include <cstdint>

#include "aos/base/list.hpp"

namespace aos {

struct DescribedDistribution;
class Sampler;

// The base of the distributions below.
class Distribution {
 public:
  double draw(Sampler& random) const;
  double log_density(double value) const;
  // The scale on which values of this distribution differ: two draws that are closer tell little apart.
  double spread() const;
  DescribedDistribution described() const;

 protected:
  enum class Kind : std::uint8_t { normal, uniform, bernoulli, discrete, normalised };

  Distribution(Kind kind, double first, double second) : kind_(kind), first_(first), second_(second) {}
  Distribution(Kind kind, const double* weights, std::size_t count) : kind_(kind), weights_(weights), count_(count) {}

  Kind kind_;
  double first_ = 0;   // the mean, a bound, or the probability of 1
  double second_ = 0;  // the deviation, or the other bound
  const double* weights_ = nullptr;
  std::size_t count_ = 0;

 private:
  void check() const;
  // The sum of the weights, and the same sum with the weight of index -1.
  std::pair<double, double> total_and_whole() const;
};

// The deviation must be positive: a number without noise has no density.
struct Normal : Distribution {
  Normal(double mean, double deviation) : Distribution(Kind::normal, mean, deviation) {}
};

// The bounds must differ, and either may be the lower one.
struct Uniform : Distribution {
  Uniform(double low, double high) : Distribution(Kind::uniform, low, high) {}
};

struct Bernoulli : Distribution {
  explicit Bernoulli(double probability) : Distribution(Kind::bernoulli, probability, 0) {}
};

struct Normalised {};
inline constexpr Normalised normalised{};

// Draws an index. With `normalised`, the weights are divided by their sum. Without it, the index is -1 with
// the probability that the weights leave below 1. An array of weights must outlive the distribution.
class Discrete : public Distribution {
 public:
  explicit Discrete(std::initializer_list<double> weights) : Distribution(Kind::discrete, weights.begin(), weights.size()) {}
  template <class Weights>
  explicit Discrete(const Weights& weights) : Distribution(Kind::discrete, nullptr, std::size(weights)) {
    if constexpr (requires { weights_ = std::data(weights); }) {
      weights_ = std::data(weights);
    } else {
      copied_.assign(std::begin(weights), std::end(weights));
      weights_ = copied_.data();
    }
  }
  template <class Weights = std::initializer_list<double>>
  Discrete(Normalised, const Weights& weights) : Discrete(weights) { kind_ = Kind::normalised; }
  Discrete(const Discrete&) = delete;
  Discrete& operator=(const Discrete&) = delete;

 private:
  List<double> copied_;  // weights that are no array of double
};

}
