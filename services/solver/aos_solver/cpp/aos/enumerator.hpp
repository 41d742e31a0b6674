// Model code over every combination of its discrete draws, each with its probability.
#pragma once

#include <cstddef>
#include <vector>

#include "aos/random.hpp"

namespace aos {

// A draw that has no finite set of outcomes, or more combinations than the budget: sampling has to do.
struct NotEnumerable {
  const char* reason;
};

inline constexpr int path_budget = 4096;

// Replays model code. One run follows one path: known choices are repeated, new ones take their first outcome. Outcomes
// of probability zero are never walked.
class Enumerator : public Draws<Enumerator> {
 public:
  double probability() const { return probability_; }

  bool flag(double probability) {
    if (probability <= 0) return false;
    if (probability >= 1) return true;
    const double weights[] = {1 - probability, probability};
    return choose(weights, 2, 1.0) == 1;
  }

  int choose(const double* weights, int count, double total) {
    if (depth_ == choices_.size()) choices_.push_back({next_outcome(weights, count, 0), 0});
    Choice& choice = choices_[depth_++];
    choice.following = next_outcome(weights, count, choice.taken + 1);
    probability_ *= weights[choice.taken] / total;
    return choice.taken;
  }

  double uniform() { throw NotEnumerable{"a draw is continuous"}; }

  // Calls `run(enumerator)` once for each path; after it, `probability()` is the path's. Throws NotEnumerable.
  template <class Run>
  void for_each_path(Run&& run) {
    choices_.clear();
    int paths = 0;
    do {
      if (++paths > path_budget) throw NotEnumerable{"a step has more than 4096 combinations of draws"};
      depth_ = 0;
      probability_ = 1;
      run(*this);
    } while (advance());
  }

 private:
  struct Choice {
    int taken;
    int following;
  };

  // The first outcome at or after `from` that can happen; -1 if there is none.
  static int next_outcome(const double* weights, int count, int from) {
    for (int i = from; i < count; ++i) {
      if (weights[i] > 0) return i;
    }
    return -1;
  }

  bool advance() {
    choices_.resize(depth_);
    while (!choices_.empty() && choices_.back().following < 0) choices_.pop_back();
    if (choices_.empty()) return false;
    choices_.back().taken = choices_.back().following;
    return true;
  }

  std::vector<Choice> choices_;
  std::size_t depth_ = 0;
  double probability_ = 1;
};

}  // namespace aos
