// The numbers that a robot observes besides a response, and the sinks that take them from a model.
//
// Model code cannot read a number that it reports, so a source of draws need not draw it. Where only the
// successor is wanted, the number is left out. Where the number was observed, its density weighs the step.
#pragma once

#include <vector>

#include "aos/draws/distributions.hpp"
#include "aos/draws/number_key.hpp"
#include "aos/draws/random.hpp"

namespace aos {

struct ObservedNumber {
  NumberKey key;
  double value;
  bool operator==(const ObservedNumber&) const = default;
};

// The numbers of one observation, in the order of their keys. The set of keys is a part of the observation.
class ObservedNumbers {
 public:
  void clear() { numbers_.clear(); }
  bool empty() const { return numbers_.empty(); }
  std::size_t size() const { return numbers_.size(); }
  const ObservedNumber& operator[](std::size_t place) const { return numbers_[place]; }
  auto begin() const { return numbers_.begin(); }
  auto end() const { return numbers_.end(); }
  bool operator==(const ObservedNumbers&) const = default;

  // Returns false if there is a number with this key already.
  bool add(NumberKey key, double value) {
    const bool is_last = numbers_.empty() || numbers_.back().key < key;
    const auto place = is_last ? numbers_.end() : std::ranges::lower_bound(numbers_, key, {}, &ObservedNumber::key);
    if (place != numbers_.end() && place->key == key) return false;
    numbers_.insert(place, {key, value});
    return true;
  }

 private:
  List<ObservedNumber> numbers_;
};

[[noreturn, gnu::cold]] void reported_twice(NumberKey key);

// Draws the numbers that a step reports.
class RecordedNumbers final : public NumberSink {
 public:
  explicit RecordedNumbers(Sampler& random) : random_(random) {}
  void begin() override { numbers_.clear(); }
  void take(NumberKey key, const Distribution& distribution) override {
    if (!numbers_.add(key, distribution.draw(random_))) reported_twice(key);
  }
  const ObservedNumbers& numbers() const { return numbers_; }

 private:
  Sampler& random_;
  ObservedNumbers numbers_;
};

// Weighs each step by the density of the observed numbers. A step that reports other keys than these has weight 0.
//
// The density of many numbers can be out of the range of a double, so weights are relative to a scale. Where
// `rescale` returns true, all steps have to be weighed again.
class WeighedNumbers final : public NumberSink {
 public:
  // With `by_value` false, only the keys that a step reports count, and not their values.
  explicit WeighedNumbers(const ObservedNumbers& observed, bool by_value = true, double log_scale = 0)
      : observed_(observed), by_value_(by_value), is_taken_(observed.size(), false), log_scale_(log_scale) {}

  const ObservedNumbers& observed() const { return observed_; }

  void begin() override {
    std::fill(is_taken_.begin(), is_taken_.end(), false);
    taken_ = 0;
    has_others_ = false;
    log_density_ = 0;
  }
  void take(NumberKey key, const Distribution& distribution) override {
    std::size_t place = taken_;  // right if the step reports in the order of keys
    if (place >= observed_.size() || observed_[place].key != key) place = find(key);
    if (place == observed_.size()) {
      has_others_ = true;
      return;
    }
    if (is_taken_[place]) reported_twice(key);
    is_taken_[place] = true;
    ++taken_;
    if (by_value_) log_density_ += distribution.log_density(observed_[place].value);
  }
  // The weight of the step since `begin`.
  double weight() override {
    if (has_others_ || taken_ < observed_.size()) return 0;
    highest_ = std::max(highest_, log_density_);
    return std::exp(log_density_ - log_scale_);
  }

  bool weighs() const override { return observed_.size() > 0 && by_value_; }
  bool write_taken(std::string& key) const override {
    for (const bool is_taken : is_taken_) key += is_taken ? '1' : '0';
    key += has_others_ ? '1' : '0';
    key.append(reinterpret_cast<const char*>(&log_density_), sizeof log_density_);
    return true;
  }

  double log_scale() const { return log_scale_; }
  bool rescale() {
    if (!std::isfinite(highest_) || std::abs(highest_ - log_scale_) < widest_range) return false;
    log_scale_ = highest_;
    return true;
  }

 private:
  static constexpr double widest_range = 300;  // a larger exponent leaves no room for sums

  std::size_t find(NumberKey key) const {
    std::size_t place = 0;
    while (place < observed_.size() && observed_[place].key != key) ++place;
    return place;
  }

  const ObservedNumbers& observed_;
  bool by_value_;
  std::vector<bool> is_taken_;
  std::size_t taken_ = 0;
  bool has_others_ = false;
  double log_density_ = 0;
  double highest_ = -std::numeric_limits<double>::infinity();
  double log_scale_;
};

// Drops all numbers. It serves callers that want successors and the rest of the observation.
class IgnoredNumbers final : public NumberSink {
 public:
  void take(NumberKey, const Distribution&) override {}
  bool write_taken(std::string&) const override { return true; }
  double log_scale() const { return 0; }
  bool rescale() { return false; }
};
inline IgnoredNumbers ignored_numbers;

// As long as this object lives, a sink takes the numbers that the source's steps report; null takes none.
template <class Source>
class ReportingTo {
 public:
  ReportingTo(Source& source, NumberSink* sink) : source_(source), before_(source.report_to(sink)) {}
  ReportingTo(const ReportingTo&) = delete;
  ReportingTo& operator=(const ReportingTo&) = delete;
  ~ReportingTo() { source_.report_to(before_); }

 private:
  Source& source_;
  NumberSink* before_;
};

}
