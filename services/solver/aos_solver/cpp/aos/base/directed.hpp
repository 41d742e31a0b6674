// Draws of which somebody decides what they give: to walk all of them, to repeat them, to try one after another.
#pragma once

#include <cstdint>
#include <utility>

#include "aos/base/random.hpp"

namespace aos {

class DirectedDraws : public Draws<DirectedDraws> {
 public:
  // What is certain is no draw.
  bool flag(double probability) {
    if (probability <= 0) return false;
    if (probability >= 1) return true;
    const double weights[] = {1 - probability, probability};
    return choose(weights, 2, 1.0) == 1;
  }

  // An index of a positive weight.
  virtual int choose(const double* weights, int count, double total) = 0;
  // In [0, 1).
  virtual double uniform() = 0;

  // For a draw that shapes only what is observed.
  SensingDraws<DirectedDraws> sensing() { return SensingDraws<DirectedDraws>{*this}; }
  bool skips_sensing() {
    meets_sensing_ = true;
    return skips_sensing_;
  }
  void skip_sensing(bool skips) { skips_sensing_ = skips; }
  // Whether there was such a draw until now.
  bool meets_sensing() const { return meets_sensing_; }

  // For a draw that goes into the reward alone. Nobody directs draws to learn of luck.
  AveragedDraws<DirectedDraws> averaged() { return AveragedDraws<DirectedDraws>{*this}; }
  static bool gives_means() { return true; }

  void report(std::uint32_t key, const Distribution& distribution) {
    if (sink_ == nullptr) return ignore_number();
    sink_->take(key, distribution);
  }
  // Returns the sink before.
  NumberSink* report_to(NumberSink* sink) { return std::exchange(sink_, sink); }

 protected:
  ~DirectedDraws() = default;

  // A number is reported, and there is no sink.
  virtual void ignore_number() {}
  void begin_numbers() {
    if (sink_ != nullptr) sink_->begin();
  }
  // What the numbers that were reported since then make of the step.
  double weight_of_numbers() const { return sink_ == nullptr ? 1 : sink_->weight(); }

 private:
  NumberSink* sink_ = nullptr;
  bool skips_sensing_ = false;
  bool meets_sensing_ = false;
};

}  // namespace aos
