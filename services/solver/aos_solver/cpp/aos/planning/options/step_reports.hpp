// What a step from a state may report: responses with the distributions of the numbers that come with them, and the
// likelihood of what was observed. Discrete draws are enumerated and continuous ones drawn, so that a step that moves at
// random has the reports of one of its next states.
#pragma once

#include "aos/draws/described_distribution.hpp"
#include "aos/draws/distributions.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/coming_to_an_end.hpp"

namespace aos {

// Keeps the distributions that a step reports from.
class KeptDistributions final : public NumberSink {
 public:
  using Kept = List<std::pair<NumberKey, DescribedDistribution>>;
  void begin() override { kept_.clear(); }
  void take(NumberKey key, const Distribution& distribution) override { kept_.emplace_back(key, distribution.described()); }
  const Kept& kept() const { return kept_; }

 private:
  Kept kept_;
};

// What was observed at a step.
struct Seen {
  Observation response = default_observation;
  List<double> numbers;  // in the order in which they were reported
};

class StepReports {
 public:
  struct Branch {
    double probability;
    Observation response;
    KeptDistributions::Kept numbers;
  };

  void clear() { branches_.clear(); }
  void add(double probability, Observation response, const KeptDistributions::Kept& numbers) {
    const auto is_it = [&](const Branch& branch) { return branch.response == response && branch.numbers == numbers; };
    const auto known = std::ranges::find_if(branches_, is_it);
    if (known != branches_.end()) known->probability += probability;
    else branches_.push_back({probability, response, numbers});
  }
  const List<Branch>& branches() const { return branches_; }

  // Whether the same is reported with the same probabilities.
  bool is_like(const StepReports& other) const {
    return std::ranges::equal(branches_, other.branches_, [](const Branch& one, const Branch& two) {
      return one.response == two.response && one.numbers == two.numbers && std::abs(one.probability - two.probability) < 1e-9;
    });
  }

  Seen drawn(Sampler& random) const {
    double place = random.uniform();
    auto chosen = std::ranges::find_if(branches_, [&](const Branch& branch) { return (place -= branch.probability) < 0; });
    if (chosen == branches_.end()) --chosen;
    Seen observed{chosen->response, {}};
    for (const auto& number : chosen->numbers) observed.numbers.push_back(number.second.quantile(random.uniform()));
    return observed;
  }

  double likelihood(const Seen& observed) const {
    double sum = 0;
    for (const Branch& branch : branches_) {
      if (branch.response != observed.response || branch.numbers.size() != observed.numbers.size()) continue;
      double log_density = 0;
      for (std::size_t i = 0; i < observed.numbers.size(); ++i) {
        log_density += branch.numbers[i].second.log_density(observed.numbers[i]);
      }
      sum += branch.probability * std::exp(log_density);
    }
    return sum;
  }

 private:
  List<Branch> branches_;
};

// All responses that may be observed; none if they are more than 8, or numbers are reported.
inline List<Observation> few_responses(const List<StepReports>& reports) {
  List<Observation> responses;
  for (const StepReports& report : reports) {
    for (const auto& branch : report.branches()) {
      if (std::ranges::find(responses, branch.response) == responses.end()) responses.push_back(branch.response);
      if (!branch.numbers.empty() || responses.size() > 8) return {};
    }
  }
  return responses;
}

// Takes a step and notes what it may report. The state becomes one of the next ones, drawn. Returns the mean reward. Each run
// of the step counts `steps` down.
template <class Model>
class ReportedStep {
 public:
  using State = typename Model::State;

  ReportedStep() { paths_.report_to(&kept_); }
  ReportedStep(const ReportedStep&) = delete;
  ReportedStep& operator=(const ReportedStep&) = delete;

  double take(State& state, int action, StepReports& reports, double& steps, Sampler& random) {
    const State start = state;
    const auto is_walked = [&](auto&& walk_all) {
      reports.clear();
      reward_ = sum_ = 0;
      return comes_to_an_end(walk_all) && sum_ > 0;
    };
    paths_.leave_numbers_to(random.bits());
    paths_.leave_world_to({});
    if (is_walked([&] { walk(start, state, action, 1, max_paths, reports, steps, random); })) return reward_ / sum_;
    // What the world does by itself may have many outcomes, and the skill few in each of a few worlds.
    const auto walk_worlds = [&] {
      for (int i = 0; i < draws; ++i) {
        paths_.leave_world_to(random.bits());
        walk(start, state, action, 1.0 / draws, max_paths_of_world, reports, steps, random);
      }
    };
    if (switches::reported_worlds && is_walked(walk_worlds)) return reward_ / sum_;
    return drawn(start, state, action, reports, steps, random);
  }

 private:
  static constexpr int max_paths = 64;
  static constexpr int draws = 8;  // of worlds, or of whole steps
  static constexpr int max_paths_of_world = 16;

  // Walks the paths from the first state; the second becomes one of the next ones.
  void walk(const State& start, State& state, int action, double weight, int most_paths, StepReports& reports, double& steps, Sampler& random) {
    Step step;
    const auto run = [&](Enumerator& path) {
      next_ = start;
      --steps;
      step = Model::step(next_, action, path);
    };
    paths_.for_nearly_each_path(run, [&](Enumerator& path) {
      const double probability = weight * path.probability();
      reports.add(probability, step.observation, kept_.kept());
      reward_ += probability * step.reward;
      sum_ += probability;
      if (random.uniform() * sum_ <= probability) state = next_;
    }, most_paths);
  }

  double drawn(const State& start, State& state, int action, StepReports& reports, double& steps, Sampler& random) {
    reports.clear();
    steps -= draws;
    double reward = 0;
    for (int i = 0; i < draws; ++i) {
      next_ = start;
      const ReportingTo reporting{random, &kept_};
      kept_.begin();
      const Step step = Model::step(next_, action, random);
      reports.add(1.0 / draws, step.observation, kept_.kept());
      reward += step.reward / draws;
    }
    state = next_;
    return reward;
  }

  Enumerator paths_;
  KeptDistributions kept_;
  State next_{};
  double reward_ = 0;  // of the paths, by their probabilities
  double sum_ = 0;     // of these
};

}
