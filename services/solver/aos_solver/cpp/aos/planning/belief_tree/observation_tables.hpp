// Tables of what is observed: each tells with which probability a step writes a text, piece by piece.
//
// A table is made of reports of runs. How often a piece was written is its probability, and the probability of a text
// is the product over its pieces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/mixed.hpp"
#include "aos/base/random.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"

namespace aos {

// What one run reported, in numbers. Reports of one kind have as many pieces.
struct NumberedReport {
  std::uint32_t kind = 0;
  std::vector<std::uint32_t> symbols;  // of the pieces
};

// An observation that was drawn from a table.
struct TabledObservation {
  static constexpr std::uint32_t nothing = 0xffffffffu;

  std::uint32_t kind = nothing;
  std::vector<std::uint32_t> symbols;
};

class ObservationTables {
 public:
  std::size_t size() const { return tables_.size(); }

  // How much of what is observed as texts no run has shown, by the share of texts that came once (Good, 1953).
  double unknown_share() const { return texts_ > 0 ? unknown_ / texts_ : 0; }

  // Adds a table, and returns its number.
  std::uint32_t add(const std::vector<NumberedReport>& reports) {
    std::map<std::uint32_t, std::vector<const NumberedReport*>> by_kind;
    for (const NumberedReport& report : reports) by_kind[report.kind].push_back(&report);
    const auto first = static_cast<std::uint32_t>(forms_.size());
    for (const auto& [kind, same] : by_kind) add_form(same, static_cast<double>(same.size()) / static_cast<double>(reports.size()));
    tables_.push_back({first, static_cast<std::uint32_t>(forms_.size())});
    return static_cast<std::uint32_t>(tables_.size() - 1);
  }

  void draw(std::uint32_t table, Sampler& random, TabledObservation& drawn) const {
    const Table& from = tables_[table];
    drawn.kind = TabledObservation::nothing;
    drawn.symbols.clear();
    if (from.first == from.last) return;
    double place = random.uniform();
    std::uint32_t chosen = from.first;
    while (chosen + 1 < from.last && place >= forms_[chosen].probability) place -= forms_[chosen++].probability;
    const Form& form = forms_[chosen];
    drawn.kind = form.kind;
    for (std::uint32_t i = form.pieces; i < form.pieces_end; ++i) drawn.symbols.push_back(pieces_[piece_ids_[i]].draw(random));
  }

  double likelihood(std::uint32_t table, const TabledObservation& seen) const {
    double sum = 0;
    for (std::uint32_t f = tables_[table].first; f < tables_[table].last; ++f) {
      const Form& form = forms_[f];
      if (form.kind != seen.kind) continue;
      double product = form.probability;
      const std::uint32_t* symbol = seen.symbols.data();
      for (std::uint32_t i = form.pieces; i < form.pieces_end && product > 0; ++i) {
        product *= pieces_[piece_ids_[i]].probability(*symbol++);
      }
      sum += product;
    }
    return sum;
  }

  void clear() { *this = {}; }

 private:
  using Key = std::vector<std::uint64_t>;

  // Probabilities of symbols. Symbols are numbered as they are met.
  struct Piece {
    std::uint32_t first = 0;
    std::vector<float> odds;
    float probability(std::uint32_t symbol) const {
      return symbol - first < odds.size() ? odds[symbol - first] : 0.0f;
    }
    std::uint32_t draw(Sampler& random) const {
      double place = random.uniform();
      std::uint32_t last = 0;
      for (std::uint32_t i = 0; i < odds.size(); ++i) {
        if (odds[i] <= 0) continue;
        last = i;
        if (place < odds[i]) break;
        place -= odds[i];
      }
      return first + last;
    }
  };
  // A response, or a text of so many pieces.
  struct Form {
    double probability;
    std::uint32_t kind;
    std::uint32_t pieces, pieces_end;
  };
  struct Table {
    std::uint32_t first, last;  // forms
  };

  void add_form(const std::vector<const NumberedReport*>& reports, double share) {
    Form form{share, reports[0]->kind, static_cast<std::uint32_t>(piece_ids_.size()), 0};
    double known = 1;
    for (std::size_t place = 0; place < reports[0]->symbols.size(); ++place) known *= 1 - add_piece(reports, place);
    form.pieces_end = static_cast<std::uint32_t>(piece_ids_.size());
    forms_.push_back(form);
    unknown_ += share * (1 - known);
    texts_ += reports[0]->symbols.empty() ? 0 : share;
  }

  // Adds the table of a piece. Returns the share of the symbols that were seen once.
  double add_piece(const std::vector<const NumberedReport*>& reports, std::size_t place) {
    std::map<std::uint32_t, std::uint32_t> counts;
    for (const NumberedReport* report : reports) ++counts[report->symbols[place]];
    Key key;
    double once = 0;
    for (const auto& [symbol, count] : counts) {
      key.push_back(std::uint64_t{symbol} << 32 | count);
      once += count == 1 && reports.size() > 1;
    }
    const auto [entry, is_new] = by_counts_.try_emplace(std::move(key), static_cast<std::uint32_t>(pieces_.size()));
    if (is_new) {
      Piece piece{counts.begin()->first, {}};
      piece.odds.resize(counts.rbegin()->first - piece.first + 1);
      for (const auto& [symbol, count] : counts) {
        piece.odds[symbol - piece.first] = static_cast<float>(count) / static_cast<float>(reports.size());
      }
      pieces_.push_back(std::move(piece));
    }
    piece_ids_.push_back(entry->second);
    return once / static_cast<double>(reports.size());
  }

  double unknown_ = 0;
  double texts_ = 0;  // how many tables are of texts, in shares
  std::vector<Table> tables_;
  std::vector<Form> forms_;
  std::vector<std::uint32_t> piece_ids_;
  std::vector<Piece> pieces_;
  std::unordered_map<Key, std::uint32_t, NumbersHash> by_counts_;
};

}  // namespace aos
