// The distributions that model code may report a number from: each draws values and tells their density. What is drawn from
// a finite set has its probability for a density.
//
// Most are made for nothing, as who simulates a step seldom wants its numbers. So making one is next to no work, and what is
// wrong with it shows when it is used, as a ModelFault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <utility>
#include <vector>

namespace aos {

struct DescribedDistribution;
class Sampler;

// One of those below.
class Distribution {
 public:
  double draw(Sampler& random) const;
  double log_density(double value) const;
  // The distance at which two draws from it begin to tell something apart.
  double spread() const;
  void describe(DescribedDistribution& description) const;

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
  // Of the weights, and of what can happen.
  std::pair<double, double> total_and_whole() const;
};

// Its deviation is positive: a number without noise has no density.
struct Normal : Distribution {
  Normal(double mean, double deviation) : Distribution(Kind::normal, mean, deviation) {}
};

// There is something between its bounds.
struct Uniform : Distribution {
  Uniform(double low, double high) : Distribution(Kind::uniform, low, high) {}
};

// 0 or 1.
struct Bernoulli : Distribution {
  explicit Bernoulli(double probability) : Distribution(Kind::bernoulli, probability, 0) {}
};

struct Normalised {};
inline constexpr Normalised normalised{};

// An index. Weights are divided by their sum where that is asked for; else the index is -1 where they leave room. They have
// to stay where they are.
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
  Discrete(Normalised, const Weights& weights) : Discrete(weights) {
    kind_ = Kind::normalised;
  }
  Discrete(const Discrete&) = delete;
  Discrete& operator=(const Discrete&) = delete;

 private:
  std::vector<double> copied_;  // of numbers that are not of type double
};

}  // namespace aos
