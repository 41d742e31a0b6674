// Tables of what is observed: each tells with which probability a step writes a text, piece by piece, and what
// distributions its numbers have.
//
// A table is made of reports of runs. How often a piece was written is its probability, and the probability of a text
// is the product over its pieces. Numbers have the density of their distributions.
#pragma once

#include <map>
#include <unordered_map>

#include "aos/base/mixed.hpp"
#include "aos/draws/described_distribution.hpp"
#include "aos/planning/belief_tree/belief_tree_constants.hpp"

namespace aos {

// What one run reported, in numbers. Reports of one kind have as many pieces, and numbers of the same names.
struct NumberedReport {
  std::uint32_t kind = 0;
  List<std::uint32_t> symbols;        // of the pieces
  List<std::uint32_t> distributions;  // of the numbers
};

// An observation that was drawn from a table.
struct TabledObservation {
  static constexpr std::uint32_t nothing = 0xffffffffu;

  std::uint32_t kind = nothing;
  List<std::uint32_t> symbols;
  List<double> values;  // of the numbers
  double log_density = 0;
};

class ObservationTables {
 public:
  std::size_t size() const { return tables_.size(); }

  // How much of what is observed as texts no run has shown, by the share of texts that came once (Good, 1953).
  double unknown_share() const { return texts_ > 0 ? unknown_ / texts_ : 0; }

  std::uint32_t number_of(const DescribedDistribution& distribution) {
    Key key{static_cast<std::uint64_t>(distribution.kind)};
    for (const double number : distribution.numbers) key.push_back(std::bit_cast<std::uint64_t>(number));
    const auto [entry, is_new] = by_parameters_.try_emplace(std::move(key), static_cast<std::uint32_t>(distributions_.size()));
    if (is_new) distributions_.push_back(distribution);
    return entry->second;
  }

  // Adds a table, and returns its number.
  std::uint32_t add(const List<NumberedReport>& reports) {
    std::map<std::pair<std::uint32_t, List<std::uint32_t>>, List<const NumberedReport*>> by_form;
    for (const NumberedReport& report : reports) by_form[{report.kind, report.distributions}].push_back(&report);
    const std::uint32_t first = forms_.size();
    for (const auto& [form, same] : by_form) add_form(same, static_cast<double>(same.size()) / static_cast<double>(reports.size()));
    tables_.push_back({first, static_cast<std::uint32_t>(forms_.size())});
    return static_cast<std::uint32_t>(tables_.size() - 1);
  }

  void draw(std::uint32_t table, Sampler& random, TabledObservation& drawn) const {
    const Table& from = tables_[table];
    drawn.kind = TabledObservation::nothing;
    drawn.log_density = 0;
    drawn.symbols.clear();
    drawn.values.clear();
    if (from.first == from.last) return;
    double place = random.uniform();
    std::uint32_t chosen = from.first;
    while (chosen + 1 < from.last && place >= forms_[chosen].probability) place -= forms_[chosen++].probability;
    const Form& form = forms_[chosen];
    drawn.kind = form.kind;
    for (std::uint32_t i = form.pieces; i < form.pieces_end; ++i) drawn.symbols.push_back(pieces_[piece_ids_[i]].draw(random));
    for (std::uint32_t i = form.numbers; i < form.numbers_end; ++i) {
      const DescribedDistribution& distribution = distributions_[number_ids_[i]];
      drawn.values.push_back(distribution.quantile(random.uniform()));
      drawn.log_density += distribution.log_density(drawn.values.back());
    }
  }

  // The probability, or the density relative to that where the numbers were drawn.
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
      if (form.numbers != form.numbers_end && product > 0) {
        double log_density = -seen.log_density;
        const double* value = seen.values.data();
        for (std::uint32_t i = form.numbers; i < form.numbers_end; ++i) {
          log_density += distributions_[number_ids_[i]].log_density(*value++);
        }
        product *= std::exp(std::min(log_density, highest_log_ratio));
      }
      sum += product;
    }
    return sum;
  }

  // Drops the tables. The distributions keep their numbers.
  void clear() {
    tables_.clear();
    forms_.clear();
    piece_ids_.clear();
    number_ids_.clear();
    pieces_.clear();
    by_counts_.clear();
    unknown_ = texts_ = 0;
  }

 private:
  using Key = List<std::uint64_t>;

  // Probabilities of symbols. Symbols are numbered as they are met.
  struct Piece {
    std::uint32_t first = 0;
    List<float> odds;
    float probability(std::uint32_t symbol) const {
      return symbol - first < odds.size() ? odds[symbol - first] : 0.0f;
    }
    std::uint32_t draw(Sampler& random) const { return first + place_in(odds.data(), static_cast<int>(odds.size()), random.uniform()); }
  };
  // A response, or a text of so many pieces, with the distributions of its numbers.
  struct Form {
    double probability;
    std::uint32_t kind;
    std::uint32_t pieces, pieces_end;
    std::uint32_t numbers, numbers_end;
  };
  struct Table {
    std::uint32_t first, last;  // forms
  };

  void add_form(const List<const NumberedReport*>& reports, double share) {
    Form form{share, reports[0]->kind, static_cast<std::uint32_t>(piece_ids_.size()), 0,
              static_cast<std::uint32_t>(number_ids_.size()), 0};
    double known = 1;
    for (std::size_t place = 0; place < reports[0]->symbols.size(); ++place) known *= 1 - add_piece(reports, place);
    number_ids_.insert(number_ids_.end(), reports[0]->distributions.begin(), reports[0]->distributions.end());
    form.pieces_end = piece_ids_.size();
    form.numbers_end = number_ids_.size();
    forms_.push_back(form);
    unknown_ += share * (1 - known);
    texts_ += reports[0]->symbols.empty() ? 0 : share;
  }

  // Adds the table of a piece. Returns the share of the symbols that were seen once.
  double add_piece(const List<const NumberedReport*>& reports, std::size_t place) {
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
    return once / reports.size();
  }

  double unknown_ = 0;
  double texts_ = 0;  // how many tables are of texts, in shares
  List<Table> tables_;
  List<Form> forms_;
  List<std::uint32_t> piece_ids_;
  List<std::uint32_t> number_ids_;
  List<Piece> pieces_;
  List<DescribedDistribution> distributions_;
  std::unordered_map<Key, std::uint32_t, NumbersHash> by_counts_;
  std::unordered_map<Key, std::uint32_t, NumbersHash> by_parameters_;
};

}
