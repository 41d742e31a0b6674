// Both bounds of the value function over the beliefs of a region, as far as they are known.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "point_based/regions.hpp"

namespace aos::point_based {

// The states that have a probability, by their numbers in the region, ascending.
struct Belief {
  std::vector<std::uint32_t> states;
  std::vector<double> probabilities;

  std::size_t size() const { return states.size(); }
};

// Values by a region's states: for every one what a plan of `length` decisions gives at least that begins with `action`.
struct AlphaVector {
  std::uint32_t action;
  std::uint32_t length;  // 0 where there is no end
  std::vector<double> values;
  double size = 0;  // of the largest value

  AlphaVector(std::uint32_t of_action, std::uint32_t of_length, std::vector<double> of_states)
      : action(of_action), length(of_length), values(std::move(of_states)) {
    for (const double value : values) size = std::max(size, std::abs(value));
  }
  bool is_gone() const { return values.empty(); }
};

// Of so many pairs of a probability and a value. In eight sums, which a processor can add up side by side.
template <class ValueOf>
double weighted_sum(const std::vector<double>& probabilities, ValueOf&& value_of) {
  constexpr std::size_t width = 8;
  double sums[width]{};
  const std::size_t whole = probabilities.size() / width * width;
  for (std::size_t i = 0; i < whole; i += width) {
    for (std::size_t j = 0; j < width; ++j) sums[j] += probabilities[i + j] * value_of(i + j);
  }
  for (std::size_t i = whole; i < probabilities.size(); ++i) sums[i - whole] += probabilities[i] * value_of(i);
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

inline double expected(const std::vector<double>& values, const Belief& belief) {
  if (belief.size() == values.size()) {
    return weighted_sum(belief.probabilities, [&](std::size_t i) { return values[i]; });
  }
  return weighted_sum(belief.probabilities, [&](std::size_t i) { return values[belief.states[i]]; });
}

// Alpha vectors of a region. Their numbers stay; those that were given up are empty. Those of the beginning are never
// given up; the first of them always do the same action.
class LowerBound {
 public:
  // Those of an action in the order of their lengths.
  void add_blind(AlphaVector vector) {
    add_initial(std::move(vector));
    ++blind_;
  }
  // After the blind ones, one for each state of the region or none at all.
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
  std::uint32_t blind() const { return blind_; }
  std::uint32_t initial() const { return initial_; }
  std::size_t kept() const { return kept_; }
  // Numbers those that were kept anew.
  void close_gaps() {
    std::erase_if(vectors_, [](const AlphaVector& vector) { return vector.is_gone(); });
  }
  // Keeps the vectors of the beginning only.
  void keep_initial() {
    vectors_.erase(vectors_.begin() + initial_, vectors_.end());
    kept_ = initial_;
  }
  // For every action the longest of its blind vectors that has no more than so many decisions.
  template <class Take>
  void for_blind(std::uint32_t left, Take&& take) const {
    for (std::uint32_t number = 0; number < blind_; ++number) {
      if (vectors_[number].length > left) continue;
      const bool is_last = number + 1 == blind_ || vectors_[number + 1].action != vectors_[number].action;
      if (is_last || vectors_[number + 1].length > left) take(number);
    }
  }

 private:
  std::deque<AlphaVector> vectors_;  // which stay where they are
  std::uint32_t blind_ = 0;
  std::uint32_t initial_ = 0;
  std::size_t kept_ = 0;
};

// Values of single states, and of beliefs that were looked at; between them the bound is interpolated from the states
// and one belief ("sawtooth": Hauskrecht, 2000).
class UpperBound {
 public:
  // `rounding` is relative, of the longest sum; `dense` is room for a belief, all 0 between calls.
  UpperBound(std::vector<double> corners, double rounding, std::vector<double>& dense)
      : corners_(std::move(corners)), dense_(dense), rounding_(rounding) {
    double size = 0;
    for (const double value : corners_) {
      size = std::max(size, std::abs(value));
      highest_ = std::max(highest_, value);
    }
    error_ = 4 * rounding * size;
  }

  // The highest value of a single state, or 0.
  double highest() const { return highest_; }

  // Interpolated from single states; `corner` below.
  double corner_of(const Belief& belief) const { return expected(corners_, belief); }

  // Takes the belief by its address: it must stay where it is. Returns the point's number.
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

  double of(const Belief& belief, double corner) {
    double drop = 0;
    spread(belief);
    for (const Point& point : points_) lower(drop, point, belief.size());
    clear(belief);
    return corner + drop + error_ - rounding_ * drop;
  }
  // `value` improved by what has changed since so many changes.
  double of(const Belief& belief, double corner, double value, std::uint32_t seen) {
    if (seen == changes_.size()) return value;
    if (changes_.size() - seen > points_.size()) return std::min(value, of(belief, corner));
    double drop = std::min(0.0, value - corner);
    spread(belief);
    for (std::size_t i = seen; i < changes_.size(); ++i) lower(drop, points_[changes_[i]], belief.size());
    clear(belief);
    return std::min(value, corner + drop + error_ - rounding_ * drop);
  }

  // Keeps the values of single states only.
  void forget_points() {
    points_.clear();
    changes_.clear();
  }

  std::uint32_t changes() const { return static_cast<std::uint32_t>(changes_.size()); }
  std::size_t points() const { return points_.size(); }

 private:
  struct Point {
    const Belief* belief;
    double drop;  // from the interpolation of the states; negative
  };

  void spread(const Belief& belief) {
    for (std::size_t i = 0; i < belief.size(); ++i) dense_[belief.states[i]] = belief.probabilities[i];
  }
  void clear(const Belief& belief) {
    for (const std::uint32_t state : belief.states) dense_[state] = 0;
  }

  // The belief in `dense_` holds a share of the point's, and so much of the drop.
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

  std::vector<double> corners_;
  std::vector<double>& dense_;
  double highest_ = 0;
  double rounding_;
  double error_ = 0;  // of interpolations from single states
  std::vector<Point> points_;
  std::vector<std::uint32_t> changes_;
};

}  // namespace aos::point_based
