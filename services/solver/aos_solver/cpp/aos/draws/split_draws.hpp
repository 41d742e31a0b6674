// Runs model code along a tree of its draws that is cut where it weighs little.
//
// A path begins with a weight. As long as it has at least a threshold, each draw splits it: all outcomes are walked, each with
// its probability. A lighter path goes on with one outcome, drawn at random, and keeps its weight. So heavy paths are
// enumerated and light ones are sampled, and the weight of any end is right on average.
//
// A light path is split as well, into a few, by draws that shape only what is observed, and by the last draws of a step: what is
// observed often depends on these, and their probabilities are its likelihood then. Which ones are the last is learnt from the
// light path before, so that it does not depend on what is drawn now.
#pragma once

#include "aos/draws/directed.hpp"
#include "aos/draws/enumerator.hpp"

namespace aos {

class SplitDraws final : public DirectedDraws {
 public:
  explicit SplitDraws(Sampler& random) : random_(random) {}

  // Begins the tree of a state of this weight.
  void start(double weight, double threshold) {
    start_weight_ = weight;
    threshold_ = threshold;
    choices_.clear();
    last_draws_ = next_last_draws_;
    begin_path();
  }
  // Goes to the next path. Returns false after the last one.
  bool advance() {
    choices_.resize(depth_);
    if (!at_.is_certain) learn_last_draws();
    while (!choices_.empty() && choices_.back().following < 0) choices_.pop_back();
    if (choices_.empty()) return false;
    choices_.back().taken = choices_.back().following;
    begin_path();
    return true;
  }

  // The weight of the path, times that of the numbers that it reports.
  double weight() const { return at_.weight * weight_of_numbers(); }
  // Whether no draw of the path was left to chance.
  bool is_certain() const { return at_.is_certain; }
  std::size_t draws() const { return depth_; }

  [[gnu::optimize("O2")]] int choose(const double* weights, int count, double total) override {
    const bool is_sensing = takes_sensing();
    // All choices but the last one are those of the path before.
    if (depth_ + 1 < choices_.size()) return choices_[depth_++].taken;
    if (depth_ == choices_.size()) {
      if (depth_ == max_draws_of_path) throw NotEnumerable{"a step draws too often"};
      const bool is_heavy = at_.weight >= threshold_;
      const bool is_split = is_heavy || ((is_sensing || depth_ >= last_draws_) && at_.branches * count <= max_light_branches);
      if (!is_split) {
        choices_.push_back({random_.choose(weights, count, total), none, count, false, at_});
        ++depth_;
        at_.is_certain = false;
        return choices_.back().taken;
      }
      choices_.push_back({next_outcome(weights, count, -1), none, count, !is_heavy, at_});
    } else {
      at_ = choices_[depth_].before;
    }
    Choice& choice = choices_[depth_++];
    choice.following = next_outcome(weights, count, choice.taken);
    at_.weight *= weights[choice.taken] / total;
    if (choice.is_light) at_.branches *= count;
    return choice.taken;
  }
  double uniform() override { throw NotEnumerable{"a draw is continuous"}; }

 private:
  static constexpr int none = -1;
  static constexpr long max_light_branches = 6;

  // What holds of a path up to a draw.
  struct Way {
    double weight;
    long branches;  // of a light path
    bool is_certain;
  };
  struct Choice {
    int taken;
    int following;  // the outcome to walk next; `none` after the last one, and where chance took the only one
    int count;
    bool is_light;  // a split of a light path
    Way before;
  };

  void begin_path() {
    depth_ = 0;
    at_ = {start_weight_, 1, true};
    begin_numbers();
  }
  // The last draws are as many as have few combinations.
  void learn_last_draws() {
    long combinations = 1;
    next_last_draws_ = choices_.size();
    while (next_last_draws_ > 0 && (combinations *= choices_[next_last_draws_ - 1].count) <= max_light_branches) --next_last_draws_;
  }
  static int next_outcome(const double* weights, int count, int taken) {
    for (int i = taken + 1; i < count; ++i) {
      if (weights[i] > 0) return i;
    }
    return none;
  }

  Sampler& random_;
  double start_weight_ = 1;
  double threshold_ = 0;
  List<Choice> choices_;
  std::size_t depth_ = 0;
  Way at_{1, 1, true};
  std::size_t last_draws_ = max_draws_of_path;  // the place of the first of them
  std::size_t next_last_draws_ = max_draws_of_path;
};

}
