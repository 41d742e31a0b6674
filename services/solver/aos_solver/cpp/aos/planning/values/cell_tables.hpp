// A function of the state as a sum of tables over few variables each, fitted to examples.
//
// A row of cells describes a state: each value of a variable is a cell, or a range of values where they are
// many. A table has one to three variables, and tables are chosen by what they explain of the examples beyond
// chance. Weights are fitted by ridge regression, table by table, and shrunk by the noise. Each half of the
// examples has its own weights, so that a choice by one half can be valued by the other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aos/model/values.hpp"
#include "aos/planning/values/value_constants.hpp"

namespace aos {

// A variable of the state as one of few cells. Cell 0 is for values that no example had.
class CellVariable {
 public:
  CellVariable(const Leaf& leaf, std::size_t offset) : leaf_(leaf), offset_(offset) {}

  double number(const void* state) const { return number_at(leaf_, static_cast<const std::byte*>(state) + offset_); }

  // Makes the cells from the numbers of the examples. Returns whether these differ.
  bool divide(std::vector<double>& numbers) {
    std::sort(numbers.begin(), numbers.end());
    lowest_ = numbers.front();
    const double range = numbers.back() - lowest_;
    if (!(range > 0 && std::isfinite(range))) return false;
    has_ranges_ = leaf_.kind == Leaf::Kind::real || range >= max_cell_values;
    if (has_ranges_) {
      for (std::size_t i = 1; i < max_cell_ranges; ++i) {
        const double limit = numbers[i * numbers.size() / max_cell_ranges];
        if (limits_.empty() || limit > limits_.back()) limits_.push_back(limit);
      }
    }
    cells_ = 2 + static_cast<std::uint32_t>(has_ranges_ ? static_cast<double>(limits_.size()) : range);
    return true;
  }

  std::uint32_t cells() const { return cells_; }
  std::uint16_t cell(const void* state) const {
    const double value = number(state);
    if (has_ranges_) {
      const auto limit = std::upper_bound(limits_.begin(), limits_.end(), value);
      return static_cast<std::uint16_t>(1 + (limit - limits_.begin()));
    }
    const double above = value - lowest_;
    return above >= 0 && above < cells_ - 1 ? static_cast<std::uint16_t>(above + 1) : 0;
  }

 private:

  Leaf leaf_;
  std::size_t offset_;
  double lowest_ = 0;
  bool has_ranges_ = false;
  std::vector<double> limits_;
  std::uint32_t cells_ = 0;
};

class CellTables {
 public:
  using Row = const std::uint16_t*;


  explicit CellTables(const std::vector<CellVariable>& variables = {}) {
    for (const CellVariable& variable : variables) cells_.push_back(variable.cells());
  }

  double value(Row row) const {
    double sum = mean_;
    for (const Table& table : tables_) sum += (weights_[0][table.place(row)] + weights_[1][table.place(row)]) / 2;
    return sum;
  }
  // The values by the weights of each half of the examples.
  std::array<double, 2> values(Row row) const {
    std::array<double, 2> sums{mean_, mean_};
    for (const Table& table : tables_) {
      const std::uint32_t place = table.place(row);
      sums[0] += weights_[0][place];
      sums[1] += weights_[1][place];
    }
    return sums;
  }
  // The variables that have a table, in ascending order.
  std::vector<std::uint32_t> used_variables() const {
    std::vector<std::uint32_t> used;
    for (const Table& table : tables_) used.insert(used.end(), table.variables, table.variables + table.order);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
  }

  // Fits the weights to the targets of the examples, whose rows follow one another in `rows`. Then adds a
  // table if one explains enough of what is left.
  void fit(const std::vector<std::uint16_t>& rows, const std::vector<double>& targets) {
    rows_ = rows.data();
    if (tables_.empty()) mean_ = mean_of(targets);
    left_.resize(targets.size());
    for (std::size_t i = 0; i < targets.size(); ++i) left_[i] = targets[i] - values(row(i))[i % 2];
    for (int pass = 0; pass < 2; ++pass) {
      for (const Table& table : tables_) fit(table);
      const double more = mean_of(left_);
      mean_ += more;
      for (double& left : left_) left -= more;
    }
    if (tables_.size() < max_cell_tables) add_table(max_unexplained_share * squares_around_mean(targets));
  }

 private:

  struct Table {
    int order = 0;
    std::uint32_t variables[max_table_order]{};
    std::uint32_t strides[max_table_order]{};
    std::uint32_t size = 1;
    std::uint32_t first = 0;  // its first weight

    std::uint32_t place(Row row) const {
      std::uint32_t place = first;
      for (int i = 0; i < order; ++i) place += row[variables[i]] * strides[i];
      return place;
    }
    bool has(std::uint32_t variable) const {
      return std::find(variables, variables + order, variable) != variables + order;
    }
  };
  struct Sum {
    double left = 0;
    double count = 0;
  };

  Row row(std::size_t example) const { return rows_ + example * cells_.size(); }

  static double mean_of(const std::vector<double>& numbers) {
    double sum = 0;
    for (const double number : numbers) sum += number;
    return sum / static_cast<double>(numbers.size());
  }
  static double squares_around_mean(const std::vector<double>& numbers) {
    const double mean = mean_of(numbers);
    double sum = 0;
    for (const double number : numbers) sum += (number - mean) * (number - mean);
    return sum;
  }

  // Fits the table's weights to what all other tables leave. The weights are shrunk by the ratio of the noise
  // within cells to the differences between cells.
  void fit(const Table& table) {
    for (std::size_t half = 0; half < 2; ++half) {
      float* const weights = &weights_[half][table.first];
      sums_.assign(table.size, {});
      double squares = 0;
      double count = 0;
      for (std::size_t i = half; i < left_.size(); i += 2) {
        Sum& sum = sums_[table.place(row(i)) - table.first];
        left_[i] += weights[table.place(row(i)) - table.first];
        sum.left += left_[i];
        squares += left_[i] * left_[i];
        ++sum.count;
        ++count;
      }
      double explained = 0;
      double cells = 0;
      for (const Sum& sum : sums_) {
        if (sum.count == 0) continue;
        explained += sum.left * sum.left / sum.count;
        ++cells;
      }
      const double noise = count > cells ? std::max(squares - explained, 0.0) / (count - cells) : squares / count;
      const double signal = std::max((explained - cells * noise) / count, 1e-3 * noise + 1e-12);
      for (std::uint32_t c = 0; c < table.size; ++c) {
        weights[c] = sums_[c].count > 0 ? static_cast<float>(sums_[c].left / (sums_[c].count + noise / signal)) : 0;
      }
      for (std::size_t i = half; i < left_.size(); i += 2) left_[i] -= weights[table.place(row(i)) - table.first];
    }
  }

  Table grown(Table table, std::uint32_t variable) const {
    table.variables[table.order] = variable;
    table.strides[table.order] = table.size;
    table.size *= cells_[variable];
    table.first = 0;
    ++table.order;
    return table;
  }

  // Adds the table that explains most: of one variable, of two if all pairs can be tried, or a known table
  // with one more variable.
  void add_table(double min_gain) {
    const auto count = static_cast<std::uint32_t>(cells_.size());
    const bool tries_pairs = count <= max_paired_variables;
    const std::size_t candidates = count * (1 + tables_.size() + (tries_pairs ? count / 2 : 0));
    const std::size_t stride = std::max<std::size_t>(candidates * left_.size() / max_tried_lookups, 1);
    double squares = 0;
    for (const double left : left_) squares += left * left;
    const double variance = squares / static_cast<double>(left_.size());
    Table best;
    double max_gain = min_gain / static_cast<double>(stride);
    const auto consider = [&](const Table& table) {
      if (table.size > max_table_cells || is_there(table)) return;
      const double found = gain(table, variance, stride);
      if (found <= max_gain) return;
      max_gain = found;
      best = table;
    };
    for (std::uint32_t a = 0; a < count; ++a) {
      consider(grown({}, a));
      for (std::uint32_t b = 0; tries_pairs && b < a; ++b) consider(grown(grown({}, b), a));
      for (const Table& table : tables_) {
        if (table.order < max_table_order && !table.has(a)) consider(grown(table, a));
      }
    }
    if (best.order == 0) return;
    best.first = static_cast<std::uint32_t>(weights_[0].size());
    for (auto& weights : weights_) weights.resize(best.first + best.size, 0);
    tables_.push_back(best);
    fit(best);
  }

  // What a table explains of every `stride`-th example, less what chance would.
  double gain(const Table& table, double variance, std::size_t stride) {
    sums_.assign(table.size, {});
    for (std::size_t i = 0; i < left_.size(); i += stride) {
      Sum& sum = sums_[table.place(row(i))];
      sum.left += left_[i];
      ++sum.count;
    }
    double gain = 0;
    for (const Sum& sum : sums_) {
      if (sum.count > 0) gain += sum.left * sum.left / (sum.count + 1) - variances_of_chance * variance;
    }
    return gain;
  }

  bool is_there(const Table& table) const {
    return std::any_of(tables_.begin(), tables_.end(), [&](const Table& other) {
      return other.order == table.order && std::all_of(table.variables, table.variables + table.order,
                                                       [&](std::uint32_t variable) { return other.has(variable); });
    });
  }


  std::vector<std::uint32_t> cells_;  // how many, by variable
  std::vector<Table> tables_;
  std::array<std::vector<float>, 2> weights_;
  double mean_ = 0;
  const std::uint16_t* rows_ = nullptr;  // while fitting
  std::vector<double> left_;             // what is left of the targets, while fitting
  std::vector<Sum> sums_;
};

}  // namespace aos
