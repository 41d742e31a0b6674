// The distributions that model code may report a number from: each draws values and tells their density. What is drawn from
// a finite set has its probability for a density.
//
// Most are made for nothing, as who simulates a step seldom wants its numbers. So making one is next to no work, and what is
// wrong with it shows when it is used, as a ModelFault.
#pragma once

#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <utility>
#include <vector>

namespace aos {

struct DescribedDistribution;
class Sampler;

class Distribution {
 public:
  virtual double draw(Sampler& random) const = 0;
  virtual double log_density(double value) const = 0;
  // The distance at which two draws from it begin to tell something apart.
  virtual double spread() const = 0;
  virtual void describe(DescribedDistribution& description) const = 0;

 protected:
  ~Distribution() = default;
};

// Its deviation is positive: a number without noise has no density.
class Normal final : public Distribution {
 public:
  Normal(double mean, double deviation) : mean_(mean), deviation_(deviation) {}
  double draw(Sampler& random) const override;
  double log_density(double value) const override;
  double spread() const override { return deviation_; }
  void describe(DescribedDistribution& description) const override;

 private:
  void check() const;
  double mean_;
  double deviation_;
};

// There is something between its bounds.
class Uniform final : public Distribution {
 public:
  Uniform(double low, double high) : low_(low), high_(high) {}
  double draw(Sampler& random) const override;
  double log_density(double value) const override;
  double spread() const override { return 0.3 * std::abs(high_ - low_); }
  void describe(DescribedDistribution& description) const override;

 private:
  void check() const;
  double low_;
  double high_;
};

inline constexpr double discrete_spread = 0.25;

// 0 or 1.
class Bernoulli final : public Distribution {
 public:
  explicit Bernoulli(double probability) : probability_(probability) {}
  double draw(Sampler& random) const override;
  double log_density(double value) const override;
  double spread() const override { return discrete_spread; }
  void describe(DescribedDistribution& description) const override;

 private:
  double probability_;
};

struct Normalised {};
inline constexpr Normalised normalised{};

// An index. Weights are divided by their sum where that is asked for; else the index is -1 where they leave room. They have
// to stay where they are.
class Discrete final : public Distribution {
 public:
  explicit Discrete(std::initializer_list<double> weights) : first_(weights.begin()), count_(weights.size()) {}
  Discrete(Normalised, std::initializer_list<double> weights) : Discrete(weights) { is_normalised_ = true; }
  template <class Weights>
  explicit Discrete(const Weights& weights) {
    if constexpr (requires { first_ = std::data(weights); }) {
      first_ = std::data(weights);
      count_ = std::size(weights);
    } else {
      copied_.assign(std::begin(weights), std::end(weights));
      first_ = copied_.data();
      count_ = copied_.size();
    }
  }
  template <class Weights>
  Discrete(Normalised, const Weights& weights) : Discrete(weights) {
    is_normalised_ = true;
  }
  Discrete(const Discrete&) = delete;
  Discrete& operator=(const Discrete&) = delete;

  double draw(Sampler& random) const override;
  double log_density(double value) const override;
  double spread() const override { return discrete_spread; }
  void describe(DescribedDistribution& description) const override;

 private:
  // Of the weights, and of what can happen.
  std::pair<double, double> total_and_whole() const;

  const double* first_ = nullptr;
  std::size_t count_ = 0;
  bool is_normalised_ = false;
  std::vector<double> copied_;  // of numbers that are not of type double
};

}  // namespace aos
