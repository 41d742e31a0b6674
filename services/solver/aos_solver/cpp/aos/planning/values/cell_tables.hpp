// A function of the state as a sum of tables over few variables each, fitted to examples.
//
// A row of cells describes a state: each value of a variable is a cell, or a range of values where they are
// many. A table has one to three variables, and tables are chosen by what they explain of the examples beyond
// chance. Weights are fitted by ridge regression, table by table, and shrunk by the noise. Each half of the
// examples has its own weights, so that a choice by one half can be valued by the other.
#pragma once

#include <array>

#include "aos/model/values.hpp"
#include "aos/planning/values/value_constants.hpp"

namespace aos {

// A variable of the state as one of few cells. Cell 0 is for values that no example had.
class CellVariable {
 public:
  explicit CellVariable(const PlacedNumber& number) : number_(number) {}

  double number(const void* state) const { return number_.of(state); }

  // Makes the cells from the numbers of the examples. Returns whether these differ.
  bool divide(List<double>& numbers);

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
  PlacedNumber number_;
  double lowest_ = 0;
  bool has_ranges_ = false;
  List<double> limits_;
  std::uint32_t cells_ = 0;
};

class CellTables {
 public:
  using Row = const std::uint16_t*;

  explicit CellTables(const List<CellVariable>& variables = {}) {
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
  List<std::uint32_t> used_variables() const;

  // Fits the weights to the targets of the examples, whose rows follow one another in `rows`. Then adds a
  // table if one explains enough of what is left.
  void fit(const List<std::uint16_t>& rows, const List<double>& targets);

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
  // A table with one more variable: its places are `places` and `stride` times the variable's cells.
  struct Candidate {
    Table table;
    const std::uint32_t* places = nullptr;
    const std::uint32_t* cells = nullptr;
    std::uint32_t stride = 0;
  };
  static constexpr std::size_t side_by_side = 4;  // tables that are tried at a time
  struct Sum {
    double left = 0;
    double count = 0;
  };

  Row row(std::size_t example) const { return rows_ + example * cells_.size(); }

  void fit(const Table& table);
  Table grown(Table table, std::uint32_t variable) const;
  void add_table(double min_gain);
  void take_columns(std::size_t stride);
  std::array<double, side_by_side> gains(const Candidate* tables, std::size_t count, double variance);
  bool is_there(const Table& table) const;

  List<std::uint32_t> cells_;  // how many, by variable
  List<Table> tables_;
  std::array<List<float>, 2> weights_;
  double mean_ = 0;
  const std::uint16_t* rows_ = nullptr;  // while fitting
  List<double> left_;             // what is left of the targets, while fitting
  List<Sum> sums_;
  // While a new table is looked for, of every so many examples:
  List<List<std::uint32_t>> columns_;  // the cells of each variable
  List<List<std::uint32_t>> places_;   // in each table
  List<std::uint32_t> none_;                  // places in a table of no variables
  List<double> sampled_;                      // what is left
};

}
