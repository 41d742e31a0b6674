// Brackets of what a belief is worth, as narrow as they are asked for: with so many decisions to go, or without an end.
//
// It is heuristic search value iteration (Smith and Simmons, 2004), by layers where the decisions are counted. Below
// are alpha vectors, each the value of a policy that could be followed. Above are the fast informed bound (Hauskrecht,
// 2000) and beliefs where a better one was found, joined by the sawtooth. Both hold at every moment, for all beliefs.
#pragma once

#include <ctime>
#include <functional>
#include <limits>

#include "aos/base/list.hpp"
#include "flat.hpp"

namespace exam {

inline double processor_seconds() {
  std::timespec spent{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

struct Bracket {
  double lower;
  double upper;
  double gap() const { return upper - lower; }
  double middle() const { return (lower + upper) / 2; }
};

class Truth {
 public:
  // `decisions` 0 counts none: values without an end, for a discount below 1.
  Truth(const Flat& flat, int decisions) : flat_(flat), decisions_(decisions) {
    if (decisions == 0) {
      layers_.resize(1);
      begin_without_end();
    } else {
      layers_.resize(static_cast<std::size_t>(decisions) + 1);
      begin_layers();
    }
  }

  int decisions() const { return decisions_; }
  // Up to which bounds are meaningless because of rounding.
  double rounding() const { return rounding_; }

  // With `left` decisions to go, which is of no meaning where none are counted.
  Bracket value(const Mass& belief, int left) const { return {lower(belief, left), upper(belief, left)}; }
  Bracket action_value(const Mass& belief, std::size_t action, int left) const {
    return action_value(flat_.expected_reward(belief, action), flat_.reached(belief, action), left);
  }

  // Until the gap is no wider, or so much processor time is spent. Returns whether it got that far.
  bool narrow(const Mass& belief, int left, double gap, double seconds) {
    const double latest = processor_seconds() + seconds;
    while (value(belief, left).gap() > gap) {
      if (processor_seconds() > latest) return false;
      trial(belief, left, gap);
      const auto is_full = [](const Layer& layer) { return layer.alphas.size() >= max_alphas; };
      if (std::any_of(layers_.begin(), layers_.end(), is_full)) return false;
    }
    return true;
  }

  // The same for an action: until its bracket is no wider.
  bool narrow_action(const Mass& belief, std::size_t action, int left, double gap, double seconds) {
    const double latest = processor_seconds() + seconds;
    bool is_narrow = true;
    for (const Reached& reached : flat_.reached(belief, action)) {
      const double rest = latest - processor_seconds();
      if (rest <= 0) return false;
      is_narrow &= narrow(reached.belief, left - 1, gap / flat_.discount(), rest);
    }
    return is_narrow;
  }

 private:
  static constexpr std::size_t max_alphas = 4000;

  struct Point {
    Mass belief;
    double value;
    double below_corners;  // how far the value is below the corners' plane
  };
  struct Layer {
    aos::List<aos::List<double>> alphas;
    aos::List<aos::List<double>> informed;  // by action
    aos::List<double> corners;                // by state
    aos::List<Point> points;
    std::size_t kept_points = 32;  // after the last pruning
    std::size_t kept_alphas = 32;
  };

  bool has_end() const { return decisions_ > 0; }
  Layer& layer(int left) { return layers_[has_end() ? static_cast<std::size_t>(left) : 0]; }
  const Layer& layer(int left) const { return layers_[has_end() ? static_cast<std::size_t>(left) : 0]; }

  double lower(const Mass& belief, int left) const {
    if (has_end() && left <= 0) return 0;
    double best = -std::numeric_limits<double>::infinity();
    for (const auto& alpha : layer(left).alphas) best = std::max(best, expected(belief, alpha));
    return best;
  }

  double upper(const Mass& belief, int left) const {
    if (has_end() && left <= 0) return 0;
    const Layer& bounds = layer(left);
    const double corners = expected(belief, bounds.corners);
    double best = corners;
    double informed = -std::numeric_limits<double>::infinity();
    for (const auto& values : bounds.informed) informed = std::max(informed, expected(belief, values));
    best = std::min(best, informed);
    for (const Point& point : bounds.points) {
      if (point.below_corners > 0) best = std::min(best, corners - share(belief, point) * point.below_corners);
    }
    return best;
  }

  // How much of a point's belief fits into another one.
  static double share(const Mass& belief, const Point& point) {
    double least = 1;
    auto entry = belief.begin();
    for (const auto& [state, weight] : point.belief) {
      while (entry != belief.end() && entry->first < state) ++entry;
      if (entry == belief.end() || entry->first != state) return 0;
      least = std::min(least, entry->second / weight);
    }
    return least;
  }

  Bracket action_value(double reward, const aos::List<Reached>& all_reached, int left) const {
    Bracket bracket{reward, reward};
    for (const Reached& reached : all_reached) {
      const Bracket later = value(reached.belief, left - 1);
      bracket.lower += flat_.discount() * reached.probability * later.lower;
      bracket.upper += flat_.discount() * reached.probability * later.upper;
    }
    return bracket;
  }

  // From a belief down to where the gap is small enough, and back up.
  void trial(const Mass& from, int left, double gap) {
    struct Met {
      Mass belief;
      int left;
    };
    aos::List<Met> path;
    Mass belief = from;
    double allowed = gap;
    const std::size_t max_depth = has_end() ? static_cast<std::size_t>(left) : 400;
    while (path.size() < max_depth && value(belief, left).gap() > allowed) {
      path.push_back({belief, left});
      double best = -std::numeric_limits<double>::infinity();
      aos::List<Reached> chosen;
      for (std::size_t action = 0; action < flat_.actions(); ++action) {
        aos::List<Reached> reached = flat_.reached(belief, action);
        const double upper = action_value(flat_.expected_reward(belief, action), reached, left).upper;
        if (upper <= best) continue;
        best = upper;
        chosen = std::move(reached);
      }
      allowed /= flat_.discount();
      double widest = 0;
      const Reached* next = nullptr;
      for (const Reached& reached : chosen) {
        const double excess = reached.probability * (value(reached.belief, left - 1).gap() - allowed);
        if (excess <= widest) continue;
        widest = excess;
        next = &reached;
      }
      if (next == nullptr) break;
      belief = next->belief;
      --left;
    }
    for (auto met = path.rbegin(); met != path.rend(); ++met) back_up(met->belief, met->left);
  }

  void back_up(const Mass& belief, int left) {
    double best_lower = -std::numeric_limits<double>::infinity();
    double best_upper = best_lower;
    std::size_t best = 0;
    for (std::size_t action = 0; action < flat_.actions(); ++action) {
      const Bracket bracket = action_value(flat_.expected_reward(belief, action), flat_.reached(belief, action), left);
      best_upper = std::max(best_upper, bracket.upper);
      if (bracket.lower <= best_lower) continue;
      best_lower = bracket.lower;
      best = action;
    }
    if (best_lower > lower(belief, left) + rounding_) add_alpha(belief, best, left);
    if (best_upper < upper(belief, left) - rounding_) add_point(belief, best_upper, left);
  }

  // The value, by state, of the action and then of the best known policies after each observation.
  void add_alpha(const Mass& belief, std::size_t action, int left) {
    std::map<int, const aos::List<double>*> later;
    if (!(has_end() && left == 1)) {
      for (const Reached& reached : flat_.reached(belief, action)) {
        later[reached.observation] = &best_alpha(reached.belief, left - 1);
      }
    }
    const aos::List<double>* const usual =
        has_end() && left == 1 ? nullptr : &layer(left - 1).alphas.front();
    aos::List<double> alpha(flat_.states(), 0.0);
    for (std::size_t state = 0; state < flat_.states(); ++state) {
      if (!flat_.problem().is_running(state)) continue;
      double value = flat_.reward(state, action);
      if (usual != nullptr) {
        for (const Branch& branch : flat_.branches(state, action)) {
          const auto found = later.find(branch.observation);
          const aos::List<double>& values = found != later.end() ? *found->second : *usual;
          value += flat_.discount() * branch.probability * values[branch.next];
        }
      }
      alpha[state] = value;
    }
    Layer& bounds = layer(left);
    bounds.alphas.push_back(std::move(alpha));
    if (bounds.alphas.size() > 2 * bounds.kept_alphas) prune_alphas(bounds);
  }

  const aos::List<double>& best_alpha(const Mass& belief, int left) const {
    const auto& alphas = layer(left).alphas;
    return *std::max_element(alphas.begin(), alphas.end(), [&](const auto& one, const auto& other) {
      return expected(belief, one) < expected(belief, other);
    });
  }

  // Those that another one is nowhere worse than.
  static void prune_alphas(Layer& bounds) {
    aos::List<aos::List<double>> kept;
    for (auto alpha = bounds.alphas.rbegin(); alpha != bounds.alphas.rend(); ++alpha) {
      const bool is_dominated = std::any_of(kept.begin(), kept.end(), [&](const auto& other) {
        return std::equal(alpha->begin(), alpha->end(), other.begin(), std::less_equal<>{});
      });
      if (!is_dominated) kept.push_back(std::move(*alpha));
    }
    std::reverse(kept.begin(), kept.end());
    bounds.alphas = std::move(kept);
    bounds.kept_alphas = std::max<std::size_t>(bounds.alphas.size(), 32);
  }

  void add_point(const Mass& belief, double value, int left) {
    Layer& bounds = layer(left);
    if (belief.size() == 1) {
      const std::uint32_t state = belief.front().first;
      const double fall = bounds.corners[state] - value;
      if (fall <= 0) return;
      bounds.corners[state] = value;
      // A point is joined with the corners of now: with those before, the line would run too low.
      for (Point& point : bounds.points) {
        for (const auto& [number, weight] : point.belief) point.below_corners -= number == state ? weight * fall : 0;
      }
      return;
    }
    bounds.points.push_back({belief, value, expected(belief, bounds.corners) - value});
    if (bounds.points.size() > 2 * bounds.kept_points) prune_points(bounds);
  }

  // Those that say no more than the other ones, and all by the corners of now.
  void prune_points(Layer& bounds) {
    aos::List<Point> points;
    points.swap(bounds.points);
    std::reverse(points.begin(), points.end());
    for (Point& point : points) {
      const double corners = expected(point.belief, bounds.corners);
      double known = corners;
      for (const Point& other : bounds.points) {
        if (other.below_corners <= 0) continue;
        known = std::min(known, corners - share(point.belief, other) * other.below_corners);
      }
      if (known <= point.value) continue;
      point.below_corners = corners - point.value;
      bounds.points.push_back(std::move(point));
    }
    std::reverse(bounds.points.begin(), bounds.points.end());
    bounds.kept_points = std::max<std::size_t>(bounds.points.size(), 32);
  }

  // Bounds to begin with ------------------------------------------------------------

  void begin_layers() {
    rounding_ = 1e-13 * flat_.largest_reward() * decisions_;
    const aos::List<double> nothing(flat_.states(), 0.0);
    layers_[0].alphas.push_back(nothing);
    layers_[0].corners = nothing;
    layers_[0].informed.assign(flat_.actions(), nothing);
    aos::List<aos::List<double>> blind(flat_.actions(), nothing);
    for (std::size_t left = 1; left < layers_.size(); ++left) {
      Layer& bounds = layers_[left];
      for (std::size_t action = 0; action < flat_.actions(); ++action) {
        const aos::List<double> later = blind[action];
        bounds.informed.push_back(nothing);
        each_running([&](std::size_t state) {
          blind[action][state] = flat_.value(state, action, later);
          bounds.informed[action][state] = informed_once_more(state, action, layers_[left - 1].informed);
        });
        bounds.alphas.push_back(blind[action]);
      }
      bounds.corners = best_of(bounds.informed);
    }
  }

  void begin_without_end() {
    const double largest = flat_.largest_reward() / (1 - flat_.discount());
    rounding_ = 1e-13 * largest;
    Layer& bounds = layers_.front();
    aos::List<double> highest(flat_.states(), 0.0);
    aos::List<double> lowest(flat_.states(), 0.0);
    each_running([&](std::size_t state) {
      highest[state] = largest;
      lowest[state] = -largest;
    });
    // Each change keeps a bound a bound, so that passes may end at any time.
    repeat(0.2, [&] {
      double change = 0;
      each_running([&](std::size_t state) {
        double best = -std::numeric_limits<double>::infinity();
        for (std::size_t action = 0; action < flat_.actions(); ++action) {
          best = std::max(best, flat_.value(state, action, highest));
        }
        change = std::max(change, highest[state] - best);
        highest[state] = std::min(highest[state], best);
      });
      return change;
    });
    for (std::size_t action = 0; action < flat_.actions(); ++action) {
      aos::List<double> values = lowest;
      repeat(0.2 / static_cast<double>(flat_.actions()), [&] {
        double change = 0;
        each_running([&](std::size_t state) {
          const double value = flat_.value(state, action, values);
          change = std::max(change, value - values[state]);
          values[state] = std::max(values[state], value);
        });
        return change;
      });
      bounds.alphas.push_back(std::move(values));
    }
    bounds.informed.assign(flat_.actions(), highest);
    repeat(0.2, [&] {
      double change = 0;
      each_running([&](std::size_t state) {
        for (std::size_t action = 0; action < flat_.actions(); ++action) {
          const double value = informed_once_more(state, action, bounds.informed);
          change = std::max(change, bounds.informed[action][state] - value);
          bounds.informed[action][state] = std::min(bounds.informed[action][state], value);
        }
      });
      return change;
    });
    bounds.corners = best_of(bounds.informed);
  }

  // Passes until nothing changes any more, or for so long.
  template <class Pass>
  void repeat(double seconds, Pass&& pass) const {
    const double latest = processor_seconds() + seconds;
    while (pass() > rounding_ && processor_seconds() < latest) {
    }
  }
  template <class Use>
  void each_running(Use&& use) const {
    for (std::size_t state = 0; state < flat_.states(); ++state) {
      if (flat_.problem().is_running(state)) use(state);
    }
  }

  static aos::List<double> best_of(const aos::List<aos::List<double>>& values) {
    aos::List<double> best = values.front();
    for (const auto& more : values) {
      for (std::size_t state = 0; state < best.size(); ++state) best[state] = std::max(best[state], more[state]);
    }
    return best;
  }
  // The state is seen now, and from the next step on only by observations.
  double informed_once_more(std::size_t state, std::size_t action,
                            const aos::List<aos::List<double>>& later) const {
    double value = flat_.reward(state, action);
    const auto& branches = flat_.branches(state, action);
    for (std::size_t first = 0; first < branches.size();) {
      std::size_t last = first;
      while (last < branches.size() && branches[last].observation == branches[first].observation) ++last;
      double best = -std::numeric_limits<double>::infinity();
      for (const auto& next : later) {
        double sum = 0;
        for (std::size_t i = first; i < last; ++i) sum += branches[i].probability * next[branches[i].next];
        best = std::max(best, sum);
      }
      value += flat_.discount() * best;
      first = last;
    }
    return value;
  }

  const Flat& flat_;
  int decisions_;
  double rounding_ = 0;
  aos::List<Layer> layers_;
};

}
