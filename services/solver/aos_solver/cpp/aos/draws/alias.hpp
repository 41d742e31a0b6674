// Draws from a finite distribution by Walker's alias method. A draw takes one random number and one
// comparison, and no branch depends on the outcome. The columns are made as in Vose (1991).
#pragma once

#include <cstdint>

#include "aos/base/list.hpp"

namespace aos {

// One of n equally likely columns for n outcomes. A draw below the threshold gives the first outcome.
template <class Outcome>
struct AliasColumn {
  std::uint64_t threshold = 0;  // in units of 2^-64
  Outcome outcomes[2]{};
};

// The outcome that 64 random bits stand for. Its probability is off by less than `count` units of 2^-64.
template <class Outcome>
const Outcome& drawn(const AliasColumn<Outcome>* columns, std::uint32_t count, std::uint64_t bits) {
  const auto product = static_cast<unsigned __int128>(bits) * count;
  const AliasColumn<Outcome>& column = columns[static_cast<std::size_t>(product >> 64)];
  return column.outcomes[static_cast<std::uint64_t>(product) >= column.threshold];
}

// Makes the columns of distributions. The working memory is kept from one distribution to the next.
template <class Outcome>
class AliasColumns {
 public:
  struct Weighted {
    Outcome outcome;
    double weight;  // positive
  };

  // Appends one column for each outcome. `total` is the sum of the outcomes' weights.
  void append(const List<Weighted>& outcomes, double total, List<AliasColumn<Outcome>>& columns) {
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
    // A light outcome fills a part of its column, and a heavy outcome fills the rest of it. Rounding may
    // leave outcomes over; each of these fills its own column.
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
  List<std::size_t> light_;
  List<std::size_t> heavy_;
  List<double> shares_;  // how many columns an outcome still has to fill
};

}
