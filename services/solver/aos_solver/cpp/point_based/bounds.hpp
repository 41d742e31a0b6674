// The lower and the upper bound of the value function over the beliefs of a region.
#pragma once

#include <deque>

#include "aos/base/statistics.hpp"
#include "point_based/regions.hpp"

namespace aos::point_based {

// A belief: the states with a positive probability, by their numbers in the region, ascending.
struct Belief {
  List<std::uint32_t> states;
  List<double> probabilities;

  std::size_t size() const { return states.size(); }
};

// What a plan gives at least from each state of a region. The plan begins with `action` and has `length` decisions.
struct AlphaVector {
  std::uint32_t action;
  std::uint32_t length;  // 0 without a horizon
  List<double> values;
  double size = 0;  // the largest absolute value

  AlphaVector(std::uint32_t of_action, std::uint32_t of_length, List<double> of_states)
      : action(of_action), length(of_length), values(std::move(of_states)), size(largest_size(values)) {}
  bool is_gone() const { return values.empty(); }
};

// The sum of probabilities times values. A processor can add up the eight partial sums side by side.
[[gnu::optimize("O3")]] double weighted_sum(const List<double>& probabilities, auto&& value_of) {
  constexpr std::size_t width = 8;
  double sums[width]{};
  const std::size_t whole = probabilities.size() / width * width;
  for (std::size_t i = 0; i < whole; i += width) {
    for (std::size_t j = 0; j < width; ++j) sums[j] += probabilities[i + j] * value_of(i + j);
  }
  for (std::size_t i = whole; i < probabilities.size(); ++i) sums[i - whole] += probabilities[i] * value_of(i);
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

inline double expected(const List<double>& values, const Belief& belief) {
  if (belief.size() == values.size()) {
    return weighted_sum(belief.probabilities, [&](std::size_t i) { return values[i]; });
  }
  return weighted_sum(belief.probabilities, [&](std::size_t i) { return values[belief.states[i]]; });
}

// The alpha vectors of a region. A vector that is given up becomes empty, and the others keep their numbers.
// The initial vectors are never given up. The first of these, the blind ones, look at nothing but the region.
class LowerBound {
 public:
  // Adds the vectors of a blind plan, in the order of their lengths.
  void add_blind(List<AlphaVector> vectors) {
    for (AlphaVector& vector : vectors) add_initial(std::move(vector));
    ends_.push_back(initial_);
  }
  // Further initial vectors are added after the blind ones: one for each state of the region, or none.
  void add_initial(AlphaVector vector) {
    add(std::move(vector));
    ++initial_;
  }
  void add(AlphaVector vector) {
    vectors_.push_back(std::move(vector));
    ++kept_;
  }
  void give_up(std::uint32_t number) {
    vectors_[number].values = {};
    --kept_;
  }
  const AlphaVector& operator[](std::uint32_t number) const { return vectors_[number]; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(vectors_.size()); }
  std::uint32_t blind() const { return ends_.empty() ? 0 : ends_.back(); }
  std::uint32_t initial() const { return initial_; }
  std::size_t kept() const { return kept_; }
  // Removes the vectors that were given up. The others get new numbers.
  void close_gaps() {
    erase_if(vectors_, [](const AlphaVector& vector) { return vector.is_gone(); });
  }
  void keep_initial() {
    vectors_.erase(vectors_.begin() + initial_, vectors_.end());
    kept_ = initial_;
  }
  // Calls `take` with the longest vector of each blind plan that has at most `left` decisions.
  void for_blind(std::uint32_t left, auto&& take) const {
    std::uint32_t first = 0;
    for (const std::uint32_t end : ends_) {
      std::uint32_t number = end;
      while (number > first && vectors_[number - 1].length > left) --number;
      if (number > first) take(number - 1);
      first = end;
    }
  }

 private:
  std::deque<AlphaVector> vectors_;  // elements of a deque stay where they are
  List<std::uint32_t> ends_;  // of each blind plan's vectors
  std::uint32_t initial_ = 0;
  std::size_t kept_ = 0;
};

// Upper bounds of single states (corners) and of beliefs that were backed up (points). The bound of any other
// belief is interpolated from the corners and one point ("sawtooth": Hauskrecht, 2000).
class UpperBound {
 public:
  // `rounding` is the relative error of the longest sum. `dense` is memory for a belief, all 0 between calls.
  UpperBound(List<double> corners, double rounding, List<double>& dense)
      : corners_(std::move(corners)), dense_(dense), rounding_(rounding) {
    for (const double value : corners_) highest_ = std::max(highest_, value);
    error_ = 4 * rounding * largest_size(corners_);
  }

  // The highest value of a single state, or 0.
  double highest() const { return highest_; }

  // The bound interpolated from the corners alone. The functions below take it as `corner`.
  double corner_of(const Belief& belief) const { return expected(corners_, belief); }

  // Adds a point and returns its number. The belief must stay where it is.
  std::uint32_t add(const Belief& belief, double corner, double value) {
    points_.push_back({&belief, value - corner});
    const auto number = static_cast<std::uint32_t>(points_.size() - 1);
    changes_.push_back(number);
    return number;
  }
  void improve(std::uint32_t number, double corner, double value) {
    points_[number].drop = std::min(points_[number].drop, value - corner);
    changes_.push_back(number);
  }

  [[gnu::optimize("O3")]] double of(const Belief& belief, double corner) {
    double drop = 0;
    spread(belief);
    for (const Point& point : points_) lower(drop, point, belief.size());
    clear(belief);
    return corner + drop + error_ - rounding_ * drop;
  }
  // Lowers `value` by what has changed after the first `seen` changes.
  [[gnu::optimize("O3")]] double of(const Belief& belief, double corner, double value, std::uint32_t seen) {
    if (seen == changes_.size()) return value;
    if (changes_.size() - seen > points_.size()) return std::min(value, of(belief, corner));
    double drop = std::min(0.0, value - corner);
    spread(belief);
    for (std::size_t i = seen; i < changes_.size(); ++i) lower(drop, points_[changes_[i]], belief.size());
    clear(belief);
    return std::min(value, corner + drop + error_ - rounding_ * drop);
  }

  // Keeps the corners only.
  void forget_points() {
    points_.clear();
    changes_.clear();
  }

  std::uint32_t changes() const { return static_cast<std::uint32_t>(changes_.size()); }
  std::size_t points() const { return points_.size(); }

 private:
  struct Point {
    const Belief* belief;
    double drop;  // the value minus the bound from the corners; negative
  };

  void spread(const Belief& belief) {
    for (std::size_t i = 0; i < belief.size(); ++i) dense_[belief.states[i]] = belief.probabilities[i];
  }
  void clear(const Belief& belief) {
    for (const std::uint32_t state : belief.states) dense_[state] = 0;
  }

  // The belief in `dense_` holds a share of the point's belief, and its bound falls by that share of the point's drop.
  void lower(double& drop, const Point& point, std::size_t support) const {
    if (point.drop >= drop || point.belief->size() > support) return;
    const double needed = drop / point.drop;
    double share = 1;
    for (std::size_t i = 0; i < point.belief->size(); ++i) {
      const double part = dense_[point.belief->states[i]];
      if (part < share * point.belief->probabilities[i]) {
        share = part / point.belief->probabilities[i];
        if (share <= needed) return;
      }
    }
    drop = share * point.drop;
  }

  List<double> corners_;
  List<double>& dense_;
  double highest_ = 0;
  double rounding_;
  double error_ = 0;  // the rounding error of a bound from the corners
  List<Point> points_;
  List<std::uint32_t> changes_;
};

}
