// Steps that lead to the observation, each with its weight: likelihood weighting for models that give no likelihood.
//
// A step is a sequence of draws. The first draws are left to chance. Each of the others (sequential
// importance sampling) has trials: one for every outcome of a discrete draw, or one in each of some strata of
// a continuous draw. A trial runs to the end of the step, with chance for the later draws, and has a promise:
//
//   1     it ended with the observation, or has written the beginning of the observed text
//   0     it ended with another observation, and no draw was left to chance
//   0.25  no text is written, and chance has not led to the observation this time
//   0.001 the text written before the next draw contradicts the observation, and chance has not led to it
//
// All promising trials of a discrete draw are followed, up to 16 branches in all. Otherwise one trial is followed: it
// is drawn in proportion to probability times promise, and its weight makes up for that. A promise of 0.001 counts as
// none while other trials are promising. Once in 10,000 draws such a trial is followed all the same, and counts by so
// much more. Only trials that are certain to fail are never followed. So the weights estimate the probability of the
// observation, and of all that comes with it, without bias, whatever the code does. (A document may assign a text anew
// after it began another one. A promise then misleads, which costs precision only.)
//
// The strata of a continuous draw are found before the trials, at eleven points and by bisection between those that
// agree and those that do not. They are long where all points give the same result, and short between different
// results. The trial in each stratum is at another point, at random, and so without bias, too.
#pragma once

#include "aos/base/function_ref.hpp"
#include "aos/draws/replay.hpp"
#include "aos/model/transition.hpp"
#include "aos/text/text_order.hpp"

namespace aos {

inline constexpr int max_branches = 16;
inline constexpr int explored_points = 9;                // of a continuous draw
inline constexpr double explored_tail = 1e-4;
inline constexpr int bisections = 5;
inline constexpr int max_alternatives = 64;              // of a discrete draw; one with more is taken as continuous
inline constexpr std::size_t max_guided_draws = 64;      // of one step; chance makes the others
inline constexpr double doubtful = 0.25;
inline constexpr double contradicted = 0.001;
inline constexpr double misled = 1e-4;   // how often a contradicted trial is followed beside others

// Whether the text of a response is being written now.
inline bool is_text_begun() { return response_text != nullptr && *response_text != no_text_response; }

template <class Model>
class GuidedStep {
 public:
  using State = typename Model::State;

  // `numbers` weighs the numbers that steps report; if it is null, they are ignored.
  GuidedStep(int action, Observation observation, NumberSink* numbers, Sampler& random)
      : action_(action), observation_(observation), random_(random), watch_(observation, random) {
    report_to(numbers);
  }

  void report_to(NumberSink* numbers) {
    replay_.report_to(numbers);
    // Each weight is asked for once a step that is visited: the sink notes the highest.
    keeps_ends_ = numbers == nullptr || !numbers->weighs();
  }

  void leave_to_chance(std::size_t draws) { by_chance_ = draws; }

  // Whether the last call left nothing to chance, apart from what has no promise.
  bool was_exhaustive() const { return is_exhaustive_; }

  // Whether a continuous draw was guided so far.
  bool meets_numbers() const { return watch_.meets_numbers(); }

  // How many steps were run so far. One that ends within its trial counts again where it is followed.
  std::size_t runs() const { return runs_; }

  using Visit = FunctionRef<void(const State& next, double weight, const List<double>& values)>;

  // Calls `visit(next, weight, values)` for steps from a state that agree with the observation. `values` are
  // all draws of a step. Returns the sum of the weights.
  double from(const State& state, Visit visit, int branches = max_branches) {
    const WholeText whole{text_};
    start_ = &state;
    values_.clear();
    depth_ = 0;
    is_exhaustive_ = by_chance_ == 0;
    if (by_chance_ > 0) {
      List<double> drawn;
      State next = state;
      replay_.start(values_, random_, &drawn);
      ++runs_;
      Model::step(next, action_, replay_);
      drawn.resize(std::min(drawn.size(), by_chance_));
      values_ = std::move(drawn);
    }
    return follow(1.0, branches, visit);
  }

 private:
  // How the text of a response, as far as it is written, compares with the observed one: it is its beginning,
  // or it is before or after it (text_order.hpp), or there is no text.
  enum class Order { agreeing = 0, before = 1, unknown = 2, after = 3 };

  // Notes what the first random draw can be, and how the response's text compares before that draw.
  class Watch final : public DrawWatcher {
   public:
    Watch(Observation observation, Sampler& random)
        : observed_(observation < default_observation ? observation_text(observation) : std::string_view{}),
          random_(random) {}

    // `alternatives` may be null. They stay empty for a continuous draw.
    void start(std::size_t given, List<Alternative>* alternatives) {
      given_ = given;
      alternatives_ = alternatives;
      order_ = Order::unknown;
    }
    Order order() const { return order_; }
    bool meets_numbers() const { return meets_numbers_; }
    Order order_of(std::string_view text) const {
      const double order = order_of_texts(text, observed_);
      return order < 0 ? Order::before : order > 0 ? Order::after : Order::agreeing;
    }
    void before_draw(std::size_t number, const double* weights, int count, double total) override {
      if (number != given_) return;
      if (is_text_begun()) order_ = order_of(*response_text);
      if (alternatives_ == nullptr) return;
      meets_numbers_ = meets_numbers_ || weights == nullptr;
      alternatives_->clear();
      const auto positive = std::count_if(weights, weights + count, [](double weight) { return weight > 0; });
      if (weights == nullptr || positive > max_alternatives) return;
      alternatives_->reserve(positive);
      double below = 0;
      for (int i = 0; i < count; ++i) {
        if (weights[i] <= 0) continue;
        alternatives_->push_back({(below + random_.uniform() * weights[i]) / total, weights[i] / total});
        below += weights[i];
      }
    }

   private:
    std::string_view observed_;
    Sampler& random_;
    std::size_t given_ = 0;
    List<Alternative>* alternatives_ = nullptr;
    Order order_ = Order::unknown;
    bool meets_numbers_ = false;
  };

  struct Trial {
    bool has_ended;  // within the given draws
    bool agrees;
    Order order;

    double promise() const {
      if (agrees) return 1;
      if (has_ended) return 0;
      return order == Order::agreeing ? 1 : order == Order::unknown ? doubtful : contradicted;
    }
  };

  // Runs the step with the draws in `values_`, and with chance for the others.
  Trial tried(List<Alternative>* alternatives) {
    next_ = *start_;
    watch_.start(values_.size(), alternatives);
    replay_.start(values_, random_, nullptr, &watch_);
    ++runs_;
    text_.clear();
    const Step step = Model::step(next_, action_, replay_);
    const bool has_ended = replay_.draws() <= values_.size();
    const bool agrees = step.observation == observation_;
    if (!has_ended) return {false, agrees, watch_.order()};
    return {true, agrees, agrees ? Order::agreeing : text_.empty() ? Order::unknown : watch_.order_of(text_)};
  }
  Trial tried_at(double value) {
    values_.push_back(value);
    const Trial trial = tried(nullptr);
    values_.pop_back();
    return trial;
  }

  // A point of a continuous draw, and the kind of its result.
  struct Point {
    double value;
    int kind;  // equal for equal results

    static int kind_of(const Trial& trial) { return 4 * (trial.has_ended ? 1 : 0) + static_cast<int>(trial.order); }
    bool agrees() const { return kind == 0 || kind == 4; }
  };

  // Finds the strata of a continuous draw, each with a random point.
  void explore(List<Alternative>& strata) {
    List<Point> points;
    add_point(points, explored_tail);
    for (int i = 0; i < explored_points; ++i) add_point(points, (i + 0.5) / explored_points);
    add_point(points, 1 - explored_tail);
    for (int i = 0; i <= explored_points; ++i) bisect(points, points[i], points[i + 1], bisections);
    std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.value < b.value; });
    double from = 0;
    const auto end_stratum = [&](double to) {
      if (to > from) strata.push_back({from + random_.uniform() * (to - from), to - from});
      from = to;
    };
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (points[i].kind == points[i + 1].kind) continue;
      end_stratum(points[i].value);
      end_stratum(points[i + 1].value);
    }
    end_stratum(1);
  }
  void add_point(List<Point>& points, double value) {
    points.push_back({value, Point::kind_of(tried_at(value))});
  }
  // Bisects between two points if one agrees, or if one is before the observed text and the other after it.
  void bisect(List<Point>& points, Point left, Point right, int depth) {
    if (depth == 0 || left.kind == right.kind) return;
    const bool is_between = (left.kind & 3) + (right.kind & 3) == 4 && (left.kind & 3) != 2;
    if (!left.agrees() && !right.agrees() && !is_between) return;
    add_point(points, (left.value + right.value) / 2);
    const Point middle = points.back();
    bisect(points, left, middle, depth - 1);
    bisect(points, middle, right, depth - 1);
  }

  // The trials of one draw. Their memory serves many steps.
  struct Trials {
    List<Alternative> alternatives;
    List<double> promises;
    List<State> ends;     // of those that ended with the observation, where they are kept
    List<int> end_of;     // the place of each alternative's end, -1 for none
    List<double> weights;  // of the ends
  };

  // Follows the step from the draws in `values_` on. Returns the sum of the weights.
  double follow(double weight, int branches, Visit visit) {
    if (values_.size() >= by_chance_ + max_guided_draws) {
      is_exhaustive_ = false;
      rest_.clear();
      replay_.start(values_, random_, &rest_);
      next_ = *start_;
      ++runs_;
      if (Model::step(next_, action_, replay_).observation != observation_) return 0;
      return visited(next_, weight * replay_.weight(), rest_, visit);
    }
    if (depth_ == trials_.size()) trials_.push_back(std::make_unique<Trials>());
    Trials& trials = *trials_[depth_];
    trials.alternatives.clear();
    const Trial reached = tried(&trials.alternatives);
    if (reached.has_ended) return reached.agrees ? visited(next_, weight * replay_.weight(), values_, visit) : 0;
    const bool is_discrete = !trials.alternatives.empty();
    if (!is_discrete) explore(trials.alternatives);
    try_all(trials);
    const List<double>& promises = trials.promises;
    const auto promising = std::count_if(promises.begin(), promises.end(), [](double p) { return p >= doubtful; });
    ++depth_;
    double sum = 0;
    if (is_discrete && promising > 0 && promising <= branches) {
      sum = follow_all(trials, weight, branches / static_cast<int>(promising), visit);
    } else {
      is_exhaustive_ = is_exhaustive_ && is_discrete;
      sum = follow_one(trials, weight, branches, visit);
    }
    --depth_;
    return sum;
  }

  void try_all(Trials& trials) {
    trials.promises.clear();
    trials.ends.clear();
    trials.end_of.clear();
    trials.weights.clear();
    for (const Alternative& alternative : trials.alternatives) {
      const Trial trial = tried_at(alternative.value);
      trials.promises.push_back(trial.promise());
      const bool is_kept = keeps_ends_ && trial.has_ended && trial.agrees;
      trials.end_of.push_back(is_kept ? static_cast<int>(trials.ends.size()) : -1);
      if (!is_kept) continue;
      trials.ends.push_back(next_);
      trials.weights.push_back(replay_.weight());
    }
  }

  static double visited(const State& next, double weight, const List<double>& values, Visit visit) {
    if (weight > 0) visit(next, weight, values);
    return weight;
  }

  // Follows each promising alternative, and now and then one of the others.
  double follow_all(const Trials& trials, double weight, int branches, Visit visit) {
    double sum = 0;
    for (std::size_t i = 0; i < trials.alternatives.size(); ++i) {
      if (trials.promises[i] < doubtful) continue;
      sum += follow_at(trials, i, weight * trials.alternatives[i].probability, branches, visit);
    }
    if (random_.flag(misled)) {
      others_ = trials.promises;
      for (double& promise : others_) promise = promise >= doubtful ? 0 : promise;
      sum += follow_drawn(trials, others_, weight / misled, visit);
    }
    return sum;
  }

  // Follows one promising alternative, or now and then one of the others.
  double follow_one(const Trials& trials, double weight, int branches, Visit visit) {
    const List<double>& promises = trials.promises;
    const auto is_promising = [](double promise) { return promise >= doubtful; };
    const bool is_mixed = std::any_of(promises.begin(), promises.end(), is_promising) &&
                          std::any_of(promises.begin(), promises.end(), [](double p) { return p > 0 && p < doubtful; });
    if (!is_mixed) return follow_drawn(trials, promises, weight, visit, branches);
    const bool is_misled = random_.flag(misled);
    others_ = promises;
    for (double& promise : others_) promise = is_promising(promise) == is_misled ? 0 : promise;
    if (is_misled) return follow_drawn(trials, others_, weight / misled, visit);
    return follow_drawn(trials, others_, weight / (1 - misled), visit, branches);
  }

  double follow_drawn(const Trials& trials, const List<double>& promises, double weight, Visit visit,
                      int branches = 1) {
    const List<Alternative>& alternatives = trials.alternatives;
    shares_.clear();
    double total = 0;
    for (std::size_t i = 0; i < alternatives.size(); ++i) {
      shares_.push_back(alternatives[i].probability * promises[i]);
      total += shares_.back();
    }
    if (total <= 0) return 0;
    is_exhaustive_ = is_exhaustive_ && alternatives.size() == 1;
    const auto chosen = static_cast<std::size_t>(random_.choose(shares_.data(), shares_.size(), total));
    return follow_at(trials, chosen, weight * total / promises[chosen], branches, visit);
  }

  double follow_at(const Trials& trials, std::size_t chosen, double weight, int branches, Visit visit) {
    values_.push_back(trials.alternatives[chosen].value);
    const int end = trials.end_of[chosen];
    double sum = 0;
    if (end >= 0 && values_.size() < by_chance_ + max_guided_draws) {
      ++runs_;
      sum = visited(trials.ends[end], weight * trials.weights[end], values_, visit);
    } else {
      sum = follow(weight, branches, visit);
    }
    values_.pop_back();
    return sum;
  }

  int action_;
  Observation observation_;
  Sampler& random_;
  Watch watch_;
  Replay replay_;
  const State* start_ = nullptr;
  State next_{};
  List<double> values_;
  List<double> rest_;
  List<std::unique_ptr<Trials>> trials_;  // of the draws that are followed now
  std::size_t depth_ = 0;
  List<double> others_;
  List<double> shares_;
  std::string text_;
  std::size_t by_chance_ = 0;
  std::size_t runs_ = 0;
  bool is_exhaustive_ = false;
  bool keeps_ends_ = true;
};

}
