// Functions of the state as sums of small tables: cell_tables.hpp.
#include "aos/planning/values/cell_tables.hpp"

#include "aos/draws/random.hpp"
#include "check.hpp"

namespace units::cell_tables_tests {

struct State {
  int small = 0;
  double real = 0;
  int large = 0;
  bool flag = false;
};

aos::CellVariable variable_at(std::size_t offset, const aos::Leaf& leaf) { return aos::CellVariable{{leaf, offset}}; }
aos::CellVariable small_variable(const State& any) { return variable_at(offsetof(State, small), aos::leaf_of(any.small)); }
aos::CellVariable real_variable(const State& any) { return variable_at(offsetof(State, real), aos::leaf_of(any.real)); }
aos::CellVariable large_variable(const State& any) { return variable_at(offsetof(State, large), aos::leaf_of(any.large)); }

TEST("Each value of a variable with few values is a cell, and values that no example had share cell 0") {
  State state;
  auto variable = small_variable(state);
  aos::List<double> numbers{5, 3, 4, 3};
  EXPECT(variable.divide(numbers));
  EXPECT_EQUAL(variable.cells(), 4u);
  for (const auto& [value, cell] : {std::pair{2, 0}, {3, 1}, {4, 2}, {5, 3}, {6, 0}}) {
    state.small = value;
    EXPECT_EQUAL(variable.cell(&state), cell);
  }
}

TEST("A variable that does not differ among the examples has no cells") {
  const State state;
  auto variable = small_variable(state);
  aos::List<double> numbers{7, 7, 7};
  EXPECT(!variable.divide(numbers));
}

TEST("Reals and numbers of a wide range have ranges, which hold about as many examples each") {
  State state;
  auto real = real_variable(state);
  auto large = large_variable(state);
  aos::List<double> reals, numbers;
  for (int i = 0; i < 2400; ++i) {
    reals.push_back(0.001 * i * i);
    numbers.push_back(10.0 * i);
  }
  EXPECT(real.divide(reals));
  EXPECT(large.divide(numbers));
  EXPECT_EQUAL(real.cells(), 25u);
  EXPECT_EQUAL(large.cells(), 25u);
  aos::List<int> held(25);
  for (int i = 0; i < 2400; ++i) {
    state.real = 0.001 * i * i;
    ++held[real.cell(&state)];
  }
  EXPECT_EQUAL(held[0], 0);
  for (std::size_t cell = 1; cell < 25; ++cell) EXPECT_EQUAL(held[cell], 100);
  state.large = -1000;
  EXPECT_EQUAL(large.cell(&state), 1);
  state.large = 1'000'000;
  EXPECT_EQUAL(large.cell(&state), 24);
}

// Examples of four variables with the values 0 to 3, and tables that are fitted to a function of them.
struct Fitted {
  static constexpr std::size_t variables = 4;
  static constexpr std::size_t examples = 4000;
  using Row = std::uint16_t[variables];
  using Function = std::function<double(const std::uint16_t* values)>;

  Fitted(const Function& function, double noise, int rounds = 8) {
    aos::List<aos::CellVariable> all;
    static const State state;
    for (std::size_t i = 0; i < variables; ++i) {
      all.push_back(small_variable(state));
      aos::List<double> numbers{0, 1, 2, 3};
      all.back().divide(numbers);
    }
    tables = aos::CellTables{all};
    aos::Sampler random{1};
    for (std::size_t example = 0; example < examples; ++example) {
      for (std::size_t i = 0; i < variables; ++i) rows.push_back(static_cast<std::uint16_t>(1 + random.below(4)));
      targets.push_back(function(&rows[example * variables]) + random.SampleNormal(0, 1) * noise);
    }
    for (int round = 0; round < rounds; ++round) tables.fit(rows, targets);
  }

  aos::CellTables tables;
  aos::List<std::uint16_t> rows;
  aos::List<double> targets;
};

TEST("A sum of functions of one variable each is found, and so are its variables") {
  const Fitted fitted{[](const std::uint16_t* row) { return 3.0 * (row[0] == 2) - 2.0 * row[2]; }, 0.1};
  EXPECT((fitted.tables.used_variables() == aos::List<std::uint32_t>{0, 2}));
  const Fitted::Row row = {2, 1, 4, 3};
  EXPECT_NEAR(fitted.tables.value(row), 3 - 8, 0.05);
}

TEST("What depends on two variables together has a table of both") {
  const Fitted fitted{[](const std::uint16_t* row) { return (row[1] + row[3]) % 2 == 0 ? 1.0 : -1.0; }, 0.1};
  EXPECT((fitted.tables.used_variables() == aos::List<std::uint32_t>{1, 3}));
  const Fitted::Row even = {1, 2, 1, 4};
  const Fitted::Row odd = {1, 2, 1, 3};
  EXPECT_NEAR(fitted.tables.value(even), 1, 0.05);
  EXPECT_NEAR(fitted.tables.value(odd), -1, 0.05);
}

TEST("Noise has no table") {
  const Fitted fitted{[](const std::uint16_t*) { return 5.0; }, 1.0};
  EXPECT(fitted.tables.used_variables().empty());
  const Fitted::Row row = {1, 2, 3, 4};
  EXPECT_NEAR(fitted.tables.value(row), 5, 0.1);
}

TEST("Each half of the examples has weights of its own, and a value is their mean") {
  const Fitted fitted{[](const std::uint16_t* row) { return 2.0 * row[0]; }, 0.5};
  const Fitted::Row row = {3, 1, 1, 1};
  const auto [first, second] = fitted.tables.values(row);
  EXPECT(first != second);
  EXPECT_NEAR((first + second) / 2, fitted.tables.value(row), 1e-6);
  EXPECT_NEAR(first, 6, 0.1);
  EXPECT_NEAR(second, 6, 0.1);
}

TEST("A cell that no example had adds nothing") {
  const Fitted fitted{[](const std::uint16_t* row) { return row[0] >= 3 ? 1.0 : -1.0; }, 0.01};
  const Fitted::Row row = {0, 1, 1, 1};
  EXPECT_NEAR(fitted.tables.value(row), 0, 0.1);
}

}
