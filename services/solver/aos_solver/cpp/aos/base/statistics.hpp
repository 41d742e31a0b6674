// What is found from samples and from probabilities.
#pragma once

#include <algorithm>
#include <cmath>

namespace aos {

// What a probability adds to an entropy, in nats.
inline double share_of_entropy(double probability) { return probability > 0 ? -probability * std::log(probability) : 0; }

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
  double error() const { return std::sqrt(std::max(squares_ / count_ - mean() * mean(), 0.0) / (count_ - 1)); }

 private:
  double sum_ = 0;
  double squares_ = 0;
  double count_ = 0;
};

}
