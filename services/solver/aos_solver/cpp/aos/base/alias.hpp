// Draws from a finite distribution by one random number and one comparison: Walker's alias method, its columns made as by
// Vose (1991). Nothing branches on what is drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aos {

// One of as many equally likely columns as there are outcomes: the first of its two outcomes below the threshold.
template <class Outcome>
struct AliasColumn {
  std::uint64_t threshold = 0;  // in units of 2^-64
  Outcome outcomes[2]{};
};

// The outcome that 64 random bits stand for, off by less than `count` units of 2^-64.
template <class Outcome>
const Outcome& drawn(const AliasColumn<Outcome>* columns, std::uint32_t count, std::uint64_t bits) {
  const auto product = static_cast<unsigned __int128>(bits) * count;
  const AliasColumn<Outcome>& column = columns[static_cast<std::size_t>(product >> 64)];
  return column.outcomes[static_cast<std::uint64_t>(product) >= column.threshold];
}

// Makes the columns of distributions; keeps its memory between them.
template <class Outcome>
class AliasColumns {
 public:
  struct Weighted {
    Outcome outcome;
    double weight;  // positive
  };

  // Appends as many columns as there are outcomes; `total` is the sum of their weights.
  void append(const std::vector<Weighted>& outcomes, double total, std::vector<AliasColumn<Outcome>>& columns) {
    const std::size_t first = columns.size();
    light_.clear();
    heavy_.clear();
    shares_.clear();
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const auto& [outcome, weight] = outcomes[i];
      columns.push_back({.outcomes = {outcome, outcome}});
      shares_.push_back(weight * static_cast<double>(outcomes.size()) / total);
      (shares_.back() < 1 ? light_ : heavy_).push_back(i);
    }
    // A light outcome fills a part of its column, and a heavy one the rest of it. What rounding leaves over fills its own.
    while (!light_.empty() && !heavy_.empty()) {
      const std::size_t light = light_.back();
      const std::size_t heavy = heavy_.back();
      light_.pop_back();
      columns[first + light].threshold = static_cast<std::uint64_t>(shares_[light] * 0x1.0p64);
      columns[first + light].outcomes[1] = outcomes[heavy].outcome;
      shares_[heavy] -= 1 - shares_[light];
      if (shares_[heavy] >= 1) continue;
      heavy_.pop_back();
      light_.push_back(heavy);
    }
  }

 private:
  std::vector<std::size_t> light_;
  std::vector<std::size_t> heavy_;
  std::vector<double> shares_;  // of a column
};

}  // namespace aos
