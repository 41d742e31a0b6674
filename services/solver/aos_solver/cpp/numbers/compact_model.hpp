// A model of millions of listed states without observations, in few bytes, and its fully observable (MDP) values.
//
// A state has no more than its distinct outcomes: of actions with the same outcomes only the best one is kept.
#pragma once

#include <cstdint>
#include <unordered_map>

#include "aos/base/list.hpp"

namespace aos {

class CompactModel {
 public:
  struct Outcome {
    std::uint32_t next;
    double probability;
  };

  void begin_state() { first_.push_back(static_cast<std::uint32_t>(words_.size())); }
  // Adds a row to the state that was begun last, or improves the reward of one that is alike. Sorts the outcomes. Throws
  // NotEnumerable where they are too many.
  void add_row(List<Outcome>& outcomes, float reward);
  // Of four bytes, of all rows.
  std::size_t words() const { return words_.size(); }

  // The values of all states, in `horizon` sweeps at most, which go through the states in turn from either end, each value
  // from the newest others (Gauss and Seidel). Empty where they do not settle.
  List<float> values(double discount, int horizon) const;

 private:
  // A row is a reward and its outcomes. Its first word is the number of its reward, shifted, the number of outcomes, and
  // whether there is one that is certain, which then has no probability.
  static constexpr std::uint32_t outcome_bits = 8;
  static constexpr std::uint32_t max_outcomes = (1u << (outcome_bits - 1)) - 1;
  static constexpr std::uint32_t max_rewards = 1u << (32 - outcome_bits);

  bool has_outcomes_of_row(std::size_t at) const;
  std::size_t length_at(std::size_t at) const {
    const std::uint32_t count = words_[at] >> 1 & max_outcomes;
    return (words_[at] & 1) != 0 ? 2 : 1 + 2 * count;
  }
  std::uint32_t number_of_reward(float reward);
  float best_at(std::size_t first, std::size_t last, float discount, const List<float>& values) const;

  List<std::uint32_t> words_;  // the rows of all states
  List<std::uint32_t> first_;  // where the rows of each state begin
  List<float> rewards_;
  std::unordered_map<float, std::uint32_t> reward_numbers_;
  List<std::uint32_t> row_;  // that is added
};

}
