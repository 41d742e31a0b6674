// The variables that differ among examples of states, each as one of few cells: what tables of states are fitted over.
#pragma once

#include "aos/model/values.hpp"
#include "aos/planning/values/cell_tables.hpp"

namespace aos {

template <class Model>
class StateCells {
 public:
  using State = typename Model::State;

  // Finds the variables that differ among the examples. Returns whether there are any.
  bool find(const List<State>& examples) {
    variables_.clear();
    List<double> numbers;
    for_each_number<Model>(examples.front(), [&](const std::string&, const PlacedNumber& number) {
      CellVariable variable{number};
      numbers.clear();
      for (const State& example : examples) numbers.push_back(variable.number(Model::bytes_of(example)));
      if (variable.divide(numbers)) variables_.push_back(variable);
    });
    return !variables_.empty();
  }
  void forget() { variables_.clear(); }

  std::size_t size() const { return variables_.size(); }
  const List<CellVariable>& variables() const { return variables_; }

  void add_row(const State& state, List<std::uint16_t>& rows) const {
    for (const CellVariable& variable : variables_) rows.push_back(variable.cell(Model::bytes_of(state)));
  }
  // The row of a state, with the cells of the `used` variables only. It lasts until the thread's next call.
  CellTables::Row row(const State& state, const List<std::uint32_t>& used) const {
    thread_local List<std::uint16_t> row;
    row.resize(variables_.size());
    for (const std::uint32_t variable : used) row[variable] = variables_[variable].cell(Model::bytes_of(state));
    return row.data();
  }

 private:
  List<CellVariable> variables_;
};

}
