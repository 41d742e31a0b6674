// What is found from samples and from probabilities.
#pragma once

#include <cmath>
#include <functional>
#include <limits>

#include "aos/base/list.hpp"

namespace aos {

// What a probability adds to an entropy, in nats.
inline double share_of_entropy(double probability) { return probability > 0 ? -probability * std::log(probability) : 0; }

// The entropy of probabilities, which are `of` each element, in nats.
template <class Elements, class Of = std::identity>
double entropy_of(const Elements& elements, Of of = {}) {
  double sum = 0;
  for (const auto& element : elements) sum += share_of_entropy(std::invoke(of, element));
  return sum;
}

// The largest absolute value of some numbers; 0 of none.
inline double largest_size(const List<double>& numbers) {
  double largest = 0;
  for (const double number : numbers) largest = std::max(largest, std::abs(number));
  return largest;
}

// The first of so many numbers with the highest worth.
int best_of(int count, auto&& worth_of) {
  int best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (int number = 0; number < count; ++number) {
    const double worth = worth_of(number);
    if (worth <= most) continue;
    most = worth;
    best = number;
  }
  return best;
}

// The mean of samples, with its standard error, which takes two of them.
class SampleMean {
 public:
  void add(double sample) {
    sum_ += sample;
    squares_ += sample * sample;
    ++count_;
  }
  double count() const { return count_; }
  double mean() const { return sum_ / count_; }
  double deviation() const { return std::sqrt(variance()); }
  double error() const { return std::sqrt(variance() / (count_ - 1)); }

 private:
  double variance() const { return std::max(squares_ / count_ - mean() * mean(), 0.0); }

  double sum_ = 0;
  double squares_ = 0;
  double count_ = 0;
};

}
