// What model code reports on its way from a state to a next state, run by run, with other draws of the sensors.
#pragma once

#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"
#include "aos/planning/belief_tree/sensed_path.hpp"
#include "aos/planning/listed/state_space.hpp"

namespace aos {

template <class Model>
class SensingRuns {
 public:
  using State = typename Model::State;
  using Report = SensedPath::Report;

  explicit SensingRuns(const StateSpace<Model>& space) : space_(space) {}

  // Walks the draws of an action that shape the next state.
  void list(std::uint32_t number, int action) {
    const ForgottenTexts forgotten;
    number_ = number;
    action_ = action;
    paths_.clear();
    Enumerator draws;
    draws.skip_sensing(true);
    draws.report_to(&ignored_numbers);
    List<int> taken;
    State next;
    const auto run = [&](Enumerator& path) {
      ++count_;
      taken.clear();
      next = space_[number];
      source_.follow(path, taken);
      Model::step(next, action, source_);
    };
    draws.for_nearly_each_path(run, [&](Enumerator& path) {
      if (Model::ending(next) != Ending::running) return;
      paths_.push_back({space_.find(next), path.probability(), taken});
    });
    blame::at(0);
  }

  // Chooses the next state that the runs lead to.
  void lead_to(std::uint32_t next) {
    paths_to_.clear();
    total_ = 0;
    for (const Path& path : paths_) {
      if (path.next != next) continue;
      paths_to_.push_back(&path);
      total_ += path.probability;
    }
  }

  // The report of a run; none if it led elsewhere, as it may where draws of sensors decide which others are made.
  std::optional<Report> run(std::size_t run, std::size_t other = SensedPath::no_draw) {
    if (paths_to_.empty()) return std::nullopt;
    const ForgottenTexts forgotten;
    const WholeText whole{text_};
    text_.clear();
    const Path& path = chosen(run);
    ++count_;
    State next = space_[number_];
    source_.repeat(path.taken, run, other);
    const Step step = Model::step(next, action_, source_);
    blame::at(0);
    if (source_.is_lost() || space_.find(next) != path.next) return std::nullopt;
    return source_.report(step.observation, text_);
  }

  // Whether a draw of a sensor changes several pieces of a text in one of some runs.
  bool has_joint_pieces() {
    for (std::size_t i = 0; i < tested_runs; ++i) {
      const std::optional<Report> before = run(i);
      if (!before || before->pieces.size() < 2) continue;
      const std::size_t draws = std::min(source_.sensing_draws(), max_tested_draws);
      for (std::size_t draw = 0; draw < draws; ++draw) {
        const std::optional<Report> after = run(i, draw);
        if (!after || after->pieces.size() != before->pieces.size()) continue;
        std::size_t changed = 0;
        for (std::size_t piece = 0; piece < before->pieces.size(); ++piece) {
          changed += before->pieces[piece] != after->pieces[piece];
        }
        if (changed > 1) return true;
      }
    }
    return false;
  }

  // How many steps of the model were run so far.
  std::uint64_t count() const { return count_; }

 private:
  struct Path {
    std::uint32_t next;
    double probability;
    List<int> taken;
  };

  // The paths to the next state have runs by their probabilities, in an order that is spread out.
  const Path& chosen(std::size_t run) const {
    constexpr std::size_t step = 37;
    double place = total_ * (((run + 1) * step % sensing_runs) + 0.5) / sensing_runs;
    std::size_t chosen = 0;
    while (chosen + 1 < paths_to_.size() && place >= paths_to_[chosen]->probability) {
      place -= paths_to_[chosen++]->probability;
    }
    return *paths_to_[chosen];
  }

  const StateSpace<Model>& space_;
  SensedPath source_;
  std::uint32_t number_ = 0;
  int action_ = 0;
  List<Path> paths_;
  List<const Path*> paths_to_;
  double total_ = 0;
  std::string text_;
  std::uint64_t count_ = 0;
};

}
