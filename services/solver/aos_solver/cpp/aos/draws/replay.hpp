// Draws as functions of numbers in [0, 1). The same numbers give the same path of model code. The first
// numbers are given, and the later ones are random.
#pragma once

#include "aos/draws/directed.hpp"
#include "aos/draws/loop_heads.hpp"

namespace aos {

// One of several outcomes of a draw. `value` is a number in [0, 1) for which `Replay` gives this outcome.
struct Alternative {
  double value;
  double probability;
};

// Is told of the draws that model code makes.
class DrawWatcher {
 public:
  // Called before draw `number`, counted from 0. `weights` is null for a continuous draw.
  virtual void before_draw(std::size_t number, const double* weights, int count, double total) = 0;

 protected:
  ~DrawWatcher() = default;
};

class Replay final : public DirectedDraws {
 public:
  // Begins a path. The arguments must outlive it. The path's numbers are appended to `record`, the watcher is told
  // of its draws, and `heads` of its loops, where these are not null.
  void start(const List<double>& given, Sampler& random, List<double>* record = nullptr,
             DrawWatcher* watcher = nullptr, LoopHeads* heads = nullptr) {
    given_ = given.data();
    count_ = given.size();
    random_ = &random;
    record_ = record;
    watcher_ = watcher;
    heads_ = heads;
    draws_ = 0;
    begin_numbers();
  }

  // The weight that the sink gives the step since `start`.
  double weight() const { return weight_of_numbers(); }

  // How many draws were made since `start`.
  std::size_t draws() const { return draws_; }

  int choose(const double* weights, int count, double total) override {
    return place_in(weights, count, next(weights, count, total) * total);
  }
  double uniform() override { return next(nullptr, 0, 1); }
  LoopHeads* loop_heads() override { return heads_; }

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
  List<double>* record_ = nullptr;
  DrawWatcher* watcher_ = nullptr;
  LoopHeads* heads_ = nullptr;
  std::size_t draws_ = 0;
};

}
