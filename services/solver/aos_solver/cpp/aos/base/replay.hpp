// Draws as functions of numbers in [0, 1): the same numbers give the same path of model code. The first ones are given,
// the others random. It can tell what the first random one could be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/base/directed.hpp"
#include "aos/base/random.hpp"

namespace aos {

// One of several outcomes of a draw: a number that stands for it, and its probability.
struct Alternative {
  double value;
  double probability;
};

// Somebody who looks on as model code draws.
class DrawWatcher {
 public:
  // Before the draw of that number. `weights` is null for a continuous draw.
  virtual void before_draw(std::size_t number, const double* weights, int count, double total) = 0;

 protected:
  ~DrawWatcher() = default;
};

class Replay final : public DirectedDraws {
 public:
  // What is given must live on. Draws are recorded, and watched, where somebody wants that.
  void start(const std::vector<double>& given, Sampler& random, std::vector<double>* record = nullptr,
             DrawWatcher* watcher = nullptr) {
    given_ = given.data();
    count_ = given.size();
    random_ = &random;
    record_ = record;
    watcher_ = watcher;
    draws_ = 0;
    begin_numbers();
  }

  // What the numbers make of the step since the start.
  double weight() const { return weight_of_numbers(); }

  // How many there were since the start.
  std::size_t draws() const { return draws_; }

  int choose(const double* weights, int count, double total) override {
    return place_in(weights, count, next(weights, count, total) * total);
  }
  double uniform() override { return next(nullptr, 0, 1); }

 private:
  double next(const double* weights, int count, double total) {
    if (watcher_ != nullptr) watcher_->before_draw(draws_, weights, count, total);
    const double value = draws_ < count_ ? given_[draws_] : random_->uniform();
    ++draws_;
    if (record_ != nullptr) record_->push_back(value);
    return value;
  }

  const double* given_ = nullptr;
  std::size_t count_ = 0;
  Sampler* random_ = nullptr;
  std::vector<double>* record_ = nullptr;
  DrawWatcher* watcher_ = nullptr;
  std::size_t draws_ = 0;
};

}  // namespace aos
