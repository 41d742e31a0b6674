// A source of draws whose subclass decides each outcome. `Enumerator` walks all outcomes; `Replay` repeats given ones.
#pragma once

#include "aos/draws/loop_heads.hpp"
#include "aos/draws/random.hpp"

namespace aos {

class DirectedDraws : public Draws<DirectedDraws> {
 public:
  // A certain flag makes no draw, so that it adds no choice to the path.
  bool flag(double probability) {
    if (probability <= 0 || probability >= 1) {
      is_sensing_ = false;
      return probability >= 1;
    }
    const double weights[] = {1 - probability, probability};
    return choose(weights, 2, 1.0) == 1;
  }

  // Returns an index whose weight is positive.
  virtual int choose(const double* weights, int count, double total) = 0;
  // Returns a number in [0, 1).
  virtual double uniform() = 0;

  // The source of draws that shape only what is observed.
  SensingDraws<DirectedDraws> sensing() { return SensingDraws<DirectedDraws>{*this}; }
  bool skips_sensing() {
    meets_sensing_ = is_sensing_ = true;
    return skips_sensing_;
  }
  void skip_sensing(bool skips) { skips_sensing_ = skips; }
  // Whether such a draw has been made so far.
  bool meets_sensing() const { return meets_sensing_; }

  // The source of draws that enter the reward alone. They give their means: directed draws serve expectations.
  AveragedDraws<DirectedDraws> averaged() { return AveragedDraws<DirectedDraws>{*this}; }
  static bool gives_means() { return true; }

  // Called between the extrinsic changes of a step and its skill.
  virtual void end_world() {}

  // Who is told of the loops in which model code draws; null if nobody is.
  virtual LoopHeads* loop_heads() { return nullptr; }

  void report(std::uint32_t key, const Distribution& distribution) {
    if (sink_ == nullptr) return ignore_number();
    sink_->take(key, distribution);
  }
  // Sets the sink of reported numbers and returns the one before.
  NumberSink* report_to(NumberSink* sink) { return std::exchange(sink_, sink); }

 protected:
  ~DirectedDraws() = default;

  // Called where a number is reported and there is no sink.
  virtual void ignore_number() {}
  void begin_numbers() {
    if (sink_ != nullptr) sink_->begin();
  }
  // The weight that the sink gives the step since `begin_numbers`; 1 without a sink.
  double weight_of_numbers() const { return sink_ == nullptr ? 1 : sink_->weight(); }
  // Writes what the sink has taken since `begin_numbers`. Returns false if it does not tell.
  bool write_numbers(std::string& key) const { return sink_ == nullptr || sink_->write_taken(key); }
  // Whether the draw that is made now shapes only what is observed. Asked once of each draw.
  bool takes_sensing() { return std::exchange(is_sensing_, false); }

 private:
  NumberSink* sink_ = nullptr;
  bool skips_sensing_ = false;
  bool meets_sensing_ = false;
  bool is_sensing_ = false;
};

}
