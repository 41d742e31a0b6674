// The steps of a small model as a table: for each state that can be reached and each action all that can come of it, so
// that a step is one random number and one look-up, whatever the documents' code would have taken.
//
// The Enumerator fills it from the documents' code. States are told apart by all that is in them, so what is drawn from
// the table has the distribution of the code. There is no table where a draw is continuous, where there would be too many
// states or outcomes, or where the code fails in any of them: steps are then left to the code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "aos/base/alias.hpp"
#include "aos/base/enumerator.hpp"
#include "aos/base/random.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/step.hpp"

namespace aos {

// Of a table that is filled in some hundredths of a second, and that caches near the processor hold.
inline constexpr std::size_t most_table_rows = 32'768;  // of a state and an action each
inline constexpr std::size_t most_table_outcomes = 131'072;
inline constexpr int most_paths_of_row = 512;
inline constexpr std::size_t most_table_work = 1'000'000;  // in draws and copies of 64 bytes
inline constexpr std::size_t most_table_state_bytes = std::size_t{16} << 20;

template <class Model>
class StepTable {
 public:
  using State = typename Model::State;
  // In place of the number of a state in which the mission has ended.
  static constexpr std::uint32_t ended = 0xffffffffu;

  struct Outcome {
    Step step;
    std::uint32_t next = ended;
  };

  // Adds what can be reached from a belief, which must be given before any draw. Returns whether there is a table. Its
  // limits are in numbers, not in time, so that decisions can be repeated; what has exceeded them once stays without.
  bool prepare(const Belief<Model>& belief) {
    if (is_impossible_ || actions() == 0) return false;
    try {
      list_starts(belief);
      while (listed_ < states_.size()) list_steps(listed_++);
    } catch (...) {
      *this = {};
      is_impossible_ = true;
      blame::at(0);
    }
    return !is_impossible_;
  }

  std::size_t size() const { return states_.size(); }
  // By number; none has ended.
  const State& operator[](std::uint32_t number) const { return *states_[number]; }

  // A state of the belief; `ended` by the probability that it has.
  std::uint32_t start(std::uint64_t bits) const {
    return drawn(starts_.data(), static_cast<std::uint32_t>(starts_.size()), bits);
  }
  const Outcome& outcome(std::uint32_t number, int action, std::uint64_t bits) const {
    const Row& row = rows_[number * actions() + static_cast<std::size_t>(action)];
    return drawn(columns_.data() + row.first, row.count, bits);
  }

 private:
  struct Row {
    std::uint32_t first;
    std::uint32_t count;
  };
  struct Hash {
    std::size_t operator()(const State& state) const { return Model::hash(state); }
  };
  using WeightedOutcome = typename AliasColumns<Outcome>::Weighted;
  using WeightedStart = typename AliasColumns<std::uint32_t>::Weighted;

  static std::size_t actions() { return static_cast<std::size_t>(Model::action_count()); }

  void list_starts(const Belief<Model>& belief) {
    std::vector<WeightedStart> outcomes;
    double total = 0;
    for (const auto& [state, weight] : belief.particles()) {
      outcomes.push_back({number_of(state), weight});
      total += weight;
    }
    starts_.clear();
    AliasColumns<std::uint32_t>{}.append(outcomes, total, starts_);
  }

  void list_steps(std::uint32_t number) {
    for (std::size_t action = 0; action < actions(); ++action) {
      outcomes_.clear();
      double total = 0;
      const auto walk = [&](Enumerator& path) {
        count_path(path);
        State next = *states_[number];
        const Step step = Model::step(next, static_cast<int>(action), path);
        add_outcome({step, number_of(next)}, path.probability());
        total += path.probability();
      };
      draws_.for_each_path(walk, most_paths_of_row);
      if (columns_.size() + outcomes_.size() > most_table_outcomes) throw NotEnumerable{"too many outcomes"};
      rows_.push_back({static_cast<std::uint32_t>(columns_.size()), static_cast<std::uint32_t>(outcomes_.size())});
      columns_of_.append(outcomes_, total, columns_);
    }
  }

  void count_path(const Enumerator& path) {
    work_ += work_of_step(path, Model::state_bytes());
    if (work_ > most_table_work) throw NotEnumerable{"too many draws"};
  }

  void add_outcome(const Outcome& outcome, double probability) {
    for (WeightedOutcome& known : outcomes_) {
      if (known.outcome.next != outcome.next || known.outcome.step != outcome.step) continue;
      known.weight += probability;
      return;
    }
    outcomes_.push_back({outcome, probability});
  }

  std::uint32_t number_of(const State& state) {
    if (Model::ending(state) != Ending::running) return ended;
    const auto [entry, is_new] = numbers_.try_emplace(state, static_cast<std::uint32_t>(states_.size()));
    if (!is_new) return entry->second;
    states_.push_back(&entry->first);
    const bool is_too_large = states_.size() * actions() > most_table_rows;
    if (is_too_large || states_.size() * sizeof(State) > most_table_state_bytes) throw NotEnumerable{"too many states"};
    return entry->second;
  }

  bool is_impossible_ = false;
  std::size_t work_ = 0;
  Enumerator draws_;
  std::unordered_map<State, std::uint32_t, Hash> numbers_;
  std::vector<const State*> states_;  // elements of `numbers_`, which stay where they are
  std::uint32_t listed_ = 0;          // have their rows
  std::vector<Row> rows_;             // by state and action
  std::vector<AliasColumn<Outcome>> columns_;
  std::vector<AliasColumn<std::uint32_t>> starts_;
  std::vector<WeightedOutcome> outcomes_;  // of the row that is listed
  AliasColumns<Outcome> columns_of_;
};

}  // namespace aos
