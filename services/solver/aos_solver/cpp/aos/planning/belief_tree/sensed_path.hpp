// Repeats a path of model code with other draws of its sensors. The draws that shape the next state are given; those
// that shape only what is observed come from strata, and the pieces of a text response are noted between them.
#pragma once

#include "aos/draws/described_distribution.hpp"
#include "aos/draws/directed.hpp"
#include "aos/draws/distributions.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/transition.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"

namespace aos {

// A draw of run `run` lies in a stratum of its own among `sensing_runs` equal ones. Which one is drawn with a seed of
// the draw's name, so that all outcomes have the same luck.
class Strata {
 public:
  double value(std::size_t run, std::uint64_t name) {
    auto& column = columns_[name];
    if (column.empty()) {
      Sampler random{name};
      for (std::size_t i = 0; i < sensing_runs; ++i) column.push_back((i + random.uniform()) / sensing_runs);
      for (std::size_t i = sensing_runs; i-- > 1;) std::swap(column[i], column[random.below(static_cast<int>(i) + 1)]);
    }
    return column[run % sensing_runs];
  }

 private:
  std::unordered_map<std::uint64_t, List<double>> columns_;  // by draw
};

class SensedPath final : public DirectedDraws, private NumberSink {
 public:
  // What a run reports. A text is cut where a draw was made after it had grown, and after separators.
  static constexpr std::string_view separators = " ,;|\n\t";
  struct Report {
    Observation response = default_observation;  // -2 for a text
    List<std::string> pieces;
    List<std::pair<NumberKey, DescribedDistribution>> numbers;
  };

  SensedPath() { report_to(this); }

  // Follows the enumerator and notes the outcomes of its draws.
  void follow(Enumerator& path, List<int>& taken) {
    start(0);
    path_ = &path;
    taken_ = &taken;
  }
  // Makes run `run` of a path. If `other` is a draw of a sensor, this draw has another stratum.
  static constexpr std::size_t no_draw = static_cast<std::size_t>(-1);
  void repeat(std::span<const int> given, std::size_t run, std::size_t other = no_draw) {
    start(run);
    given_ = given;
    other_ = other;
  }
  // How many draws of sensors were made.
  std::size_t sensing_draws() const { return sensing_; }
  // Whether the run has left the given path.
  bool is_lost() const { return is_lost_; }

  // What a step has reported whose text was `text`.
  Report report(Observation observation, const std::string& text) {
    Report report{observation, {}, std::move(numbers_)};
    if (observation >= default_observation) return report;
    report.response = default_observation - 1;
    if (is_rewritten_ || !text.starts_with(written_)) cuts_.clear();
    std::size_t from = 0;
    for (std::size_t at = 1; at <= text.size(); ++at) {
      const bool is_cut = std::ranges::binary_search(cuts_, at) || separators.find(text[at - 1]) != std::string_view::npos;
      if (!is_cut && at < text.size()) continue;
      report.pieces.push_back(text.substr(from, at - from));
      from = at;
    }
    return report;
  }

  // Where paths are listed, those of loops are cut as the enumerator cuts them.
  LoopHeads* loop_heads() override { return path_ == nullptr ? nullptr : path_->loop_heads(); }

  int choose(const double* weights, int count, double total) override {
    if (takes_sensing()) return place_in(weights, count, sensed() * total);
    if (path_ != nullptr) {
      taken_->push_back(path_->choose(weights, count, total));
      return taken_->back();
    }
    if (next_ < given_.size() && given_[next_] < count && weights[given_[next_]] > 0) return given_[next_++];
    is_lost_ = true;
    return place_in(weights, count, total / 2);
  }
  double uniform() override {
    if (takes_sensing()) return sensed();
    if (path_ != nullptr) return path_->uniform();
    is_lost_ = true;
    return 0.5;
  }

 private:
  void start(std::size_t run) {
    path_ = nullptr;
    given_ = {};
    run_ = run;
    other_ = no_draw;
    next_ = sensing_ = since_cut_ = 0;
    is_lost_ = is_rewritten_ = false;
    numbers_.clear();
    cuts_.clear();
    written_.clear();
    takes_sensing();  // a step that was broken off may have left it
  }
  double sensed() {
    if (response_text != nullptr && *response_text != no_text_response) {
      is_rewritten_ = is_rewritten_ || !response_text->starts_with(written_);
      if (response_text->size() > written_.size() || cuts_.empty()) {
        written_ = *response_text;
        cuts_.push_back(written_.size());
        since_cut_ = 0;
      }
    }
    // Draws are named by the piece that follows them. So the others stay the same where one piece takes more of them.
    const std::uint64_t name = std::uint64_t{cuts_.size()} << 32 | since_cut_++;
    const bool is_other = sensing_++ == other_;
    return strata_.value(is_other ? run_ + sensing_runs / 2 : run_, name);
  }
  void take(NumberKey key, const Distribution& distribution) override { numbers_.emplace_back(key, distribution.described()); }

  Strata strata_;
  Enumerator* path_ = nullptr;
  List<int>* taken_ = nullptr;
  std::span<const int> given_;
  std::size_t run_ = 0;
  std::size_t other_ = no_draw;
  std::size_t next_ = 0;
  std::size_t sensing_ = 0;    // draws of sensors so far
  std::size_t since_cut_ = 0;  // of these
  bool is_lost_ = false;
  bool is_rewritten_ = false;
  List<std::pair<NumberKey, DescribedDistribution>> numbers_;
  std::string written_;
  List<std::size_t> cuts_;
};

}
