// The steps of a small model as a table: a step is one random number and one look-up, whatever the documents' code takes.
//
// Draws have the distribution of the code. The reward of a step is its expectation in its state, which leaves the mean of returns
// as it is and makes their spread smaller.
#pragma once

#include "aos/draws/alias.hpp"
#include "aos/planning/listed/state_space.hpp"

namespace aos {

// The limits of a table that fits the caches near the processor.
inline constexpr std::size_t max_table_rows = 32'768;  // one for each state and action
inline constexpr std::size_t max_table_outcomes = 131'072;

template <class Model>
class StepTable {
 public:
  // Stands for all states in which the mission has ended.
  static constexpr std::uint32_t ended = no_state;

  struct Outcome {
    Step step;
    std::uint32_t next = ended;
  };

  // Makes the table of a space that lists the belief's states. Returns whether the model is small enough.
  bool prepare(const StateSpace<Model>& space, const Belief<Model>& belief) {
    if (!space.lists_observations() || space.estimates_draws()) return false;
    if (space.numbering() != numbering_) list(space);
    if (!is_small_) return false;
    List<typename AliasColumns<std::uint32_t>::Weighted> starts;
    double running = 0;
    for (const auto& [number, weight] : space.weights_of(belief)) {
      starts.push_back({number, weight});
      running += weight;
    }
    if (const double over = belief.total() - running; over > 0) starts.push_back({ended, over});
    starts_.clear();
    AliasColumns<std::uint32_t>{}.append(starts, belief.total(), starts_);
    return true;
  }

  std::size_t size() const { return numbering_.states; }

  // Draws a state of the belief, or `ended` with the probability of the belief's ended part.
  std::uint32_t start(std::uint64_t bits) const {
    return drawn(starts_.data(), static_cast<std::uint32_t>(starts_.size()), bits);
  }
  const Outcome& outcome(std::uint32_t number, int action, std::uint64_t bits) const {
    const Row& row = rows_[number * actions_ + static_cast<std::size_t>(action)];
    return drawn(columns_.data() + row.first, row.count, bits);
  }

 private:
  struct Row {
    std::uint32_t first;
    std::uint32_t count;
  };

  void list(const StateSpace<Model>& space) {
    numbering_ = space.numbering();
    actions_ = space.actions();
    rows_.clear();
    columns_.clear();
    const std::size_t count = numbering_.states * actions_;
    is_small_ = count <= max_table_rows;
    for (std::size_t row = 0; is_small_ && row < count; ++row) {
      add_row(space, row);
      is_small_ = columns_.size() <= max_table_outcomes;
    }
  }

  void add_row(const StateSpace<Model>& space, std::size_t row) {
    const point_based::FlatModel& rows = space.rows();
    const int skill = Model::skill_of(static_cast<int>(row % actions_));
    outcomes_.clear();
    double running = 0;
    for (const auto& outcome : rows.outcomes[row]) {
      for (const auto& likelihood : rows.likelihoods[outcome.sensing]) {
        const Step step{rows.rewards[row], space.observations().of(skill, likelihood.observation)};
        outcomes_.push_back({{step, outcome.next}, outcome.probability * likelihood.probability});
      }
      running += outcome.probability;
    }
    constexpr double rounding = 1e-12;
    if (running < 1 - rounding) outcomes_.push_back({{{rows.rewards[row], default_observation}, ended}, 1 - running});
    double total = 0;
    for (const auto& outcome : outcomes_) total += outcome.weight;
    rows_.push_back({static_cast<std::uint32_t>(columns_.size()), static_cast<std::uint32_t>(outcomes_.size())});
    columns_of_.append(outcomes_, total, columns_);
  }

  Numbering numbering_;
  std::size_t actions_ = 0;
  bool is_small_ = false;
  List<Row> rows_;  // by state and action
  List<AliasColumn<Outcome>> columns_;
  List<AliasColumn<std::uint32_t>> starts_;
  List<typename AliasColumns<Outcome>::Weighted> outcomes_;  // of the row that is listed
  AliasColumns<Outcome> columns_of_;
};

}
