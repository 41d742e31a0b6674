#include "aos/planning/values/cell_tables.hpp"

#include <cmath>

namespace aos {

namespace {

double mean_of(const List<double>& numbers) {
  double sum = 0;
  for (const double number : numbers) sum += number;
  return sum / numbers.size();
}
double squares_around_mean(const List<double>& numbers) {
  const double mean = mean_of(numbers);
  double sum = 0;
  for (const double number : numbers) sum += (number - mean) * (number - mean);
  return sum;
}

}  // namespace

bool CellVariable::divide(List<double>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  lowest_ = numbers.front();
  const double range = numbers.back() - lowest_;
  if (!(range > 0 && std::isfinite(range))) return false;
  has_ranges_ = number_.leaf.kind == Leaf::Kind::real || range >= max_cell_values;
  if (has_ranges_) {
    for (std::size_t i = 1; i < max_cell_ranges; ++i) {
      const double limit = numbers[i * numbers.size() / max_cell_ranges];
      if (limits_.empty() || limit > limits_.back()) limits_.push_back(limit);
    }
  }
  cells_ = 2 + static_cast<std::uint32_t>(has_ranges_ ? static_cast<double>(limits_.size()) : range);
  return true;
}

List<std::uint32_t> CellTables::used_variables() const {
  List<std::uint32_t> used;
  for (const Table& table : tables_) used.insert(used.end(), table.variables, table.variables + table.order);
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

void CellTables::fit(const List<std::uint16_t>& rows, const List<double>& targets) {
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

// Fits the table's weights to what all other tables leave. The weights are shrunk by the ratio of the noise
// within cells to the differences between cells.
[[gnu::optimize("O3")]] void CellTables::fit(const Table& table) {
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

CellTables::Table CellTables::grown(Table table, std::uint32_t variable) const {
  table.variables[table.order] = variable;
  table.strides[table.order] = table.size;
  table.size *= cells_[variable];
  table.first = 0;
  ++table.order;
  return table;
}

// Adds the table that explains most: of one variable, of two if all pairs can be tried, or a known table
// with one more variable.
void CellTables::add_table(double min_gain) {
  const std::uint32_t count = cells_.size();
  const bool tries_pairs = count <= max_paired_variables;
  const std::size_t numbers = count * (1 + tables_.size() + (tries_pairs ? count / 2 : 0));
  const std::size_t stride = std::max<std::size_t>(numbers * left_.size() / max_tried_lookups, 1);
  double squares = 0;
  for (const double left : left_) squares += left * left;
  const double variance = squares / left_.size();
  take_columns(stride);
  List<Candidate> candidates;
  const auto consider = [&](const Table& table, const List<std::uint32_t>& places, std::uint32_t variable) {
    const Table more = grown(table, variable);
    if (more.size <= max_table_cells && !is_there(more)) candidates.push_back({more, places.data(), columns_[variable].data(), table.size});
  };
  for (std::uint32_t a = 0; a < count; ++a) {
    consider({}, none_, a);
    for (std::uint32_t b = 0; tries_pairs && b < a; ++b) consider(grown({}, b), columns_[b], a);
    for (std::size_t t = 0; t < tables_.size(); ++t) {
      if (tables_[t].order < max_table_order && !tables_[t].has(a)) consider(tables_[t], places_[t], a);
    }
  }
  Table best;
  double max_gain = min_gain / stride;
  for (std::size_t i = 0; i < candidates.size(); i += side_by_side) {
    const std::array<double, side_by_side> found = gains(&candidates[i], candidates.size() - i, variance);
    for (std::size_t k = 0; k < std::min(side_by_side, candidates.size() - i); ++k) {
      if (found[k] <= max_gain) continue;
      max_gain = found[k];
      best = candidates[i + k].table;
    }
  }
  if (best.order == 0) return;
  best.first = weights_[0].size();
  for (auto& weights : weights_) weights.resize(best.first + best.size, 0);
  tables_.push_back(best);
  fit(best);
}

// Reads every `stride`-th example once for all tables that are considered.
void CellTables::take_columns(std::size_t stride) {
  columns_.assign(cells_.size(), {});
  places_.assign(tables_.size(), {});
  sampled_.clear();
  for (std::size_t i = 0; i < left_.size(); i += stride) {
    sampled_.push_back(left_[i]);
    for (std::size_t v = 0; v < columns_.size(); ++v) columns_[v].push_back(row(i)[v]);
    for (std::size_t t = 0; t < places_.size(); ++t) places_[t].push_back(tables_[t].place(row(i)) - tables_[t].first);
  }
  none_.assign(sampled_.size(), 0);
}

// What tables explain of the examples, less what chance would. Their sums do not wait for one another. The last tables may be
// fewer.
[[gnu::optimize("O3")]] std::array<double, CellTables::side_by_side> CellTables::gains(const Candidate* tables, std::size_t count, double variance) {
  std::array<Candidate, side_by_side> all;
  std::array<std::size_t, side_by_side + 1> first{};
  for (std::size_t k = 0; k < side_by_side; ++k) {
    all[k] = tables[std::min(k, count - 1)];
    first[k + 1] = first[k] + all[k].table.size;
  }
  sums_.assign(first.back(), {});
  for (std::size_t i = 0; i < sampled_.size(); ++i) {
    for (std::size_t k = 0; k < side_by_side; ++k) {
      Sum& sum = sums_[first[k] + all[k].places[i] + all[k].cells[i] * all[k].stride];
      sum.left += sampled_[i];
      ++sum.count;
    }
  }
  std::array<double, side_by_side> gains{};
  for (std::size_t k = 0; k < side_by_side; ++k) {
    for (std::size_t c = first[k]; c < first[k + 1]; ++c) {
      const Sum& sum = sums_[c];
      if (sum.count > 0) gains[k] += sum.left * sum.left / (sum.count + 1) - variances_of_chance * variance;
    }
  }
  return gains;
}

bool CellTables::is_there(const Table& table) const {
  return std::any_of(tables_.begin(), tables_.end(), [&](const Table& other) {
    return other.order == table.order && std::all_of(table.variables, table.variables + table.order,
                                                     [&](std::uint32_t variable) { return other.has(variable); });
  });
}

}  // namespace aos
