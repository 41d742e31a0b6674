// The sources of draws. Document code knows only the interface `Draws`. `Sampler` draws at random,
// `DirectedDraws` (directed.hpp) decide what a draw gives, and `AnySource` stands for either.
#pragma once

#include <concepts>
#include <stdexcept>

#include "aos/base/list.hpp"
#include "aos/draws/loop_heads.hpp"
#include "aos/draws/normal.hpp"
#include "aos/draws/xoshiro.hpp"

namespace aos {

// Throws a ModelFault. The function is kept out of the code that runs in every step.
[[noreturn, gnu::cold]] void bad_weights(const char* text);

// A sum of weights that is this close to 1 is meant to be 1: single precision explains the difference.
inline constexpr double weight_rounding = 1e-5;

// What has elements, also where documents give it as it is, as `vector<int>{2, 5}`.
template <class Values>
concept ListOfValues = requires(Values&& values) {
  std::begin(values);
  std::size(values);
};

// Weights that stand in one piece, so that a draw needs no copy of them.
template <class Weights>
concept InOnePiece = requires(const Weights& weights) {
  { std::data(weights) } -> std::same_as<const double*>;
  std::size(weights);
};

// The element of that number; of a list that nobody keeps a copy of it. Throws std::out_of_range where there is none.
template <class Values>
decltype(auto) element_of(Values&& values, int number) {
  if (static_cast<std::size_t>(number) >= std::size(values)) throw std::out_of_range{"there are fewer values than weights"};
  if constexpr (std::is_lvalue_reference_v<Values>) {
    return *std::next(std::begin(values), number);
  } else {
    auto element = *std::next(std::begin(values), number);
    return element;
  }
}

class Distribution;

// Takes the numbers that a step reports. The sinks are in observed_numbers.hpp.
class NumberSink {
 public:
  // Called where a step begins.
  virtual void begin() {}
  virtual void take(std::uint32_t key, const Distribution& distribution) = 0;
  // The weight of the step since `begin`, as far as its numbers tell. It is 1 for every step unless `weighs()`.
  virtual double weight() { return 1; }
  virtual bool weighs() const { return false; }
  // Appends all that decides what later numbers of the step do. Returns false if that is not known.
  virtual bool write_taken(std::string& /*key*/) const { return false; }

 protected:
  ~NumberSink() = default;
};

// The built-ins that document code calls on `AOS` and `AOSUtils`. A source gives `flag(probability)`,
// `choose(weights, count, total)` with a positive total, and `uniform()`.
template <class Source>
class Draws {
 public:
  bool Bernoulli(double probability) { return source().flag(probability); }

  // Draws a value of an enum whose first value is `name + 1`. Weights are normalised; missing ones are zero.
  int SampleDiscrete(int name, std::initializer_list<double> weights) {
    return name + 1 + normalised(weights.begin(), static_cast<int>(weights.size()));
  }
  template <class Weights>
  int SampleDiscrete(int name, const Weights& weights) {
    if constexpr (InOnePiece<Weights>) return name + 1 + normalised(std::data(weights), static_cast<int>(std::size(weights)));
    const Copied copied{weights};
    return name + 1 + normalised(copied.weights, copied.count);
  }

  // Draws a value of an enum whose values count from 0.
  template <class Enum, class Weights = std::initializer_list<double>>
    requires std::is_enum_v<Enum>
  Enum SampleDiscrete(const Weights& weights) { return static_cast<Enum>(SampleDiscrete(-1, weights)); }
  // Draws one of several values.
  template <class Value, class Weights = std::initializer_list<double>>
  Value SampleOf(std::initializer_list<Value> values, const Weights& weights) {
    return values.begin()[SampleDiscrete(-1, weights)];
  }
  // Draws an element of a list or an array. Where there are fewer elements than weights, `element_of` tells it.
  template <ListOfValues Values, class Weights = std::initializer_list<double>>
  decltype(auto) SampleDiscrete(Values&& values, const Weights& weights) {
    return element_of(std::forward<Values>(values), SampleDiscrete(-1, weights));
  }

  // Draws an index. The weights are not normalised: the index is -1 with the probability that they leave
  // below 1. A gap of at most `weight_rounding` counts as none.
  template <class Weights = std::initializer_list<double>>
    requires(!std::is_enum_v<Weights>)
  int SampleDiscrete(const Weights& weights) {
    if constexpr (InOnePiece<Weights>) {
      const auto count = static_cast<int>(std::size(weights));
      const double total = checked_total(std::data(weights), count, /*may_be_zero=*/true);
      if (1 - total <= weight_rounding) return source().choose(std::data(weights), count, total);
    }
    Copied copied{weights};
    const double total = checked_total(copied.weights, copied.count, /*may_be_zero=*/true);
    if (1 - total <= weight_rounding) return source().choose(copied.weights, copied.count, total);
    // An index more stands for none.
    copied.append(1 - total);
    const int drawn = source().choose(copied.weights, copied.count, 1.0);
    return drawn == copied.count - 1 ? -1 : drawn;
  }

  double SampleNormal(double mean, double deviation) {
    return mean + deviation * normal_quantile(source().uniform() + 0x1p-54);
  }
  double SampleUniform(double low, double high) { return low + (high - low) * source().uniform(); }

  // The source of draws that shape only what is observed. Some sources skip these draws.
  Source& sensing() { return source(); }
  // The source of draws that enter the reward alone, and linearly. Some sources give the mean instead.
  Source& averaged() { return source(); }
  // Who is told of the loops in which model code draws; null if nobody is.
  static constexpr LoopHeads* loop_heads() { return nullptr; }

  void SetNull(bool& value) { value = false; }
  void Uninitialize(bool& value) { value = false; }
  void Initialize(bool& value) { value = true; }
  bool IsInitialized(bool value) { return value; }

 private:
  // A copy of weights, without memory of its own as long as they are few.
  struct Copied {
    template <class Weights>
    explicit Copied(const Weights& from) {
      for (const double weight : from) append(weight);
    }
    Copied(const Copied&) = delete;
    Copied& operator=(const Copied&) = delete;
    void append(double weight) {
      if (count == capacity) grow();
      weights[count++] = weight;
    }
    [[gnu::cold]] void grow() {
      if (many.empty()) many.assign(weights, weights + count);
      many.resize(static_cast<std::size_t>(capacity *= 2));
      weights = many.data();
    }
    std::array<double, 256> few;
    List<double> many;
    double* weights = few.data();
    int count = 0;
    int capacity = static_cast<int>(few.size());
  };

  Source& source() { return static_cast<Source&>(*this); }

  int normalised(const double* weights, int count) {
    return source().choose(weights, count, checked_total(weights, count, /*may_be_zero=*/false));
  }

  static double checked_total(const double* weights, int count, bool may_be_zero) {
    double total = 0;
    for (int i = 0; i < count; ++i) {
      if (!(weights[i] >= 0)) bad_weights("a weight is negative or not a number");
      total += weights[i];
    }
    if (total <= 0 && !may_be_zero) bad_weights("all weights of a draw are zero");
    return total;
  }
};

// The index whose positive weight covers `place`, which is from 0 to the total of the weights.
template <class Weight>
int place_in(const Weight* weights, int count, double place) {
  int last = 0;
  for (int i = 0; i < count; ++i) {
    if (weights[i] <= 0) continue;
    if (place < weights[i]) return i;
    place -= weights[i];
    last = i;
  }
  return last;
}

// Draws at random.
class Sampler : public Draws<Sampler>, public Xoshiro {
 public:
  using Xoshiro::Xoshiro;

  // Returns a number in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  // Returns a whole number in [0, bound).
  int below(int bound) {
    return static_cast<int>((static_cast<unsigned __int128>(bits()) * static_cast<unsigned>(bound)) >> 64);
  }

  bool flag(double probability) { return uniform() < probability; }
  // Without a sink, a reported number is not drawn.
  void report(std::uint32_t key, const Distribution& distribution) {
    if (sink_ != nullptr) sink_->take(key, distribution);
  }
  // Sets the sink of reported numbers and returns the one before.
  NumberSink* report_to(NumberSink* sink) { return std::exchange(sink_, sink); }
  static void end_world() {}

  int choose(const double* weights, int count, double total) { return place_in(weights, count, uniform() * total); }

 private:
  NumberSink* sink_ = nullptr;
};

// The draws that shape only what is observed. A source may skip them; it then gives one of the possible outcomes.
template <class Source>
class SensingDraws : public Draws<SensingDraws<Source>> {
 public:
  explicit SensingDraws(Source& source) : source_(source) {}

  bool flag(double probability) { return source_.skips_sensing() ? probability > 0 : source_.flag(probability); }
  int choose(const double* weights, int count, double total) {
    if (!source_.skips_sensing()) return source_.choose(weights, count, total);
    int first = 0;
    while (weights[first] <= 0) ++first;
    return first;
  }
  double uniform() { return source_.skips_sensing() ? 0.5 : source_.uniform(); }

 private:
  Source& source_;
};

// The draws that enter the reward alone, and linearly, from a source that may give their means. The
// expectation of the reward stays the same.
template <class Source>
class AveragedDraws {
 public:
  explicit AveragedDraws(Source& source) : source_(source) {}

  double SampleNormal(double mean, double deviation) {
    return source_.gives_means() ? mean : source_.SampleNormal(mean, deviation);
  }
  double SampleUniform(double low, double high) {
    return source_.gives_means() ? low + (high - low) / 2 : source_.SampleUniform(low, high);
  }

 private:
  Source& source_;
};

class DirectedDraws;

// Stands for a source of any kind, which must outlive it. Code that draws from it is compiled once for all kinds.
class AnySource : public Draws<AnySource> {
 public:
  struct Functions {
    bool (*flag)(void* source, double probability);
    int (*choose)(void* source, const double* weights, int count, double total);
    double (*uniform)(void* source);
    bool (*skips_sensing)(void* source);
    bool gives_means;
    void (*report)(void* source, std::uint32_t key, const Distribution& distribution);
    LoopHeads* (*loop_heads)(void* source);
    void (*end_world)(void* source);
  };

  explicit AnySource(Sampler& sampler);
  explicit AnySource(DirectedDraws& draws);

  bool flag(double probability) { return functions_.flag(source_, probability); }
  int choose(const double* weights, int count, double total) {
    return functions_.choose(source_, weights, count, total);
  }
  double uniform() { return functions_.uniform(source_); }
  bool skips_sensing() const { return functions_.skips_sensing(source_); }
  SensingDraws<AnySource> sensing() { return SensingDraws<AnySource>{*this}; }
  bool gives_means() const { return functions_.gives_means; }
  AveragedDraws<AnySource> averaged() { return AveragedDraws<AnySource>{*this}; }
  void report(std::uint32_t key, const Distribution& distribution) { functions_.report(source_, key, distribution); }
  LoopHeads* loop_heads() { return functions_.loop_heads(source_); }
  void end_world() { functions_.end_world(source_); }

 private:
  void* source_;
  const Functions& functions_;
};

}
