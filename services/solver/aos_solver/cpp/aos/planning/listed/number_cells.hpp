// The observations of a robot that tells numbers only by the cells of a grid. There are finitely many of them, so
// searches that enumerate observations can look ahead. The grid is the same for all states and actions.
//
// A robot that observes numbers can act as if it observed only their cells. So a value over cells is a lower
// bound of the true value. An upper bound over cells bounds nothing.
#pragma once

#include <map>
#include <set>

#include "aos/planning/listed/number_grid.hpp"
#include "aos/planning/listed/number_reports.hpp"
#include "point_based/flat_model.hpp"

namespace aos {

class NumberCells {
 public:
  // The most combinations of cells of the numbers that a step reports together.
  static constexpr std::size_t max_combinations = 256;
  // How far the probabilities of a report's cells may be from the true ones, in sum.
  static constexpr double error = 1e-13;

  // Chooses the cells. Returns why there can be none, or an empty text.
  std::string choose(const NumberReports& reports, std::size_t max = max_combinations) {
    if (reports.is_full()) return "too many different distributions of numbers are reported";
    make_grids(reports);
    for (NumberGrid& grid : grids_) grid.merge_alike();
    max = std::min(max, max_likelihoods / std::max<std::size_t>(reports.reports().size(), 1));
    std::set<List<std::uint32_t>> sets;
    for (const auto& report : reports.reports()) sets.insert(gauges_of(reports, report));
    max_cells_ = 1;
    for (const auto& gauges : sets) {
      while (combinations(gauges) > max) {
        NumberGrid* const next = next_to_merge(gauges);
        if (next == nullptr) {
          return std::to_string(gauges.size()) +
                 " numbers are observed at once, with too many combinations even of two cells each";
        }
        next->merge();
      }
    }
    for (const auto& gauges : sets) max_cells_ = std::max(max_cells_, combinations(gauges));
    expand(reports);
    return {};
  }

  // The largest number of cells for one report.
  std::size_t max_cells() const { return max_cells_; }
  std::size_t observations() const { return observations_; }

  // The same likelihoods with cells in place of reports.
  point_based::Rows<point_based::Likelihood> by_cells(const point_based::Rows<point_based::Likelihood>& reported) const {
    point_based::Rows<point_based::Likelihood> result;
    result.first.push_back(0);
    std::map<std::uint32_t, double> sums;
    for (std::size_t row = 0; row + 1 < reported.first.size(); ++row) {
      sums.clear();
      for (const auto& likelihood : reported[row]) {
        for (const auto& [observation, probability] : cells_of_[likelihood.observation]) {
          sums[observation] += likelihood.probability * probability;
        }
      }
      for (const auto& [observation, probability] : sums) result.elements.push_back({observation, probability});
      result.first.push_back(result.elements.size());
    }
    return result;
  }

 private:
  static constexpr std::size_t max_likelihoods = 8'000'000;

  static List<std::uint32_t> gauges_of(const NumberReports& reports, const NumberReports::Report& report) {
    List<std::uint32_t> gauges;
    for (const std::uint32_t part : report.parts) gauges.push_back(reports.parts()[part].gauge);
    return gauges;
  }

  void make_grids(const NumberReports& reports) {
    List<double> weights(reports.parts().size());
    for (const auto& report : reports.reports()) {
      for (const std::uint32_t part : report.parts) ++weights[part];
    }
    List<List<NumberGrid::Source>> sources(reports.gauges());
    for (std::size_t part = 0; part < weights.size(); ++part) {
      const auto& [gauge, distribution] = reports.parts()[part];
      sources[gauge].push_back({&distribution, weights[part]});
    }
    grids_.clear();
    for (const auto& of_gauge : sources) grids_.emplace_back(of_gauge);
  }

  std::size_t combinations(const List<std::uint32_t>& gauges) const {
    std::size_t product = 1;
    for (const std::uint32_t gauge : gauges) {
      if (product > max_likelihoods) break;
      product *= grids_[gauge].cells();
    }
    return product;
  }

  // The grid that loses least for the combinations that its next merge saves; null if all grids have two cells.
  NumberGrid* next_to_merge(const List<std::uint32_t>& gauges) {
    NumberGrid* next = nullptr;
    double min_loss = std::numeric_limits<double>::infinity();
    for (const std::uint32_t gauge : gauges) {
      NumberGrid& grid = grids_[gauge];
      if (grid.cells() <= 2) continue;
      const auto cells = static_cast<double>(grid.cells());
      const double loss = grid.next_loss() / std::log(cells / (cells - 1));
      if (next != nullptr && loss >= min_loss) continue;
      next = &grid;
      min_loss = loss;
    }
    return next;
  }

  // Numbers the observations. A response with a set of numbers takes consecutive ones, one for each
  // combination of cells.
  void expand(const NumberReports& reports) {
    List<List<double>> probabilities;
    for (const auto& [gauge, distribution] : reports.parts()) {
      probabilities.push_back(grids_[gauge].probabilities_of(distribution));
    }
    std::map<std::pair<std::uint32_t, List<std::uint32_t>>, std::uint32_t> first;
    observations_ = 0;
    cells_of_.clear();
    for (const auto& report : reports.reports()) {
      List<std::uint32_t> gauges = gauges_of(reports, report);
      const std::size_t count = combinations(gauges);
      const auto number = static_cast<std::uint32_t>(observations_);
      const auto [entry, is_new] = first.try_emplace({report.response, std::move(gauges)}, number);
      if (is_new) observations_ += count;
      List<point_based::Likelihood> cells{{0, 1.0}};
      for (const std::uint32_t part : report.parts) cells = multiplied(cells, probabilities[part]);
      for (point_based::Likelihood& cell : cells) cell.observation += entry->second;
      cells_of_.push_back(without_the_unlikeliest(std::move(cells)));
    }
  }

  static List<point_based::Likelihood> multiplied(const List<point_based::Likelihood>& cells,
                                                      const List<double>& by) {
    List<point_based::Likelihood> result;
    for (const auto& [observation, probability] : cells) {
      for (std::size_t cell = 0; cell < by.size(); ++cell) {
        const auto number = static_cast<std::uint32_t>(observation * by.size() + cell);
        if (probability * by[cell] > 0) result.push_back({number, probability * by[cell]});
      }
    }
    return result;
  }

  // Gives the probability of negligible cells to the likeliest cell.
  static List<point_based::Likelihood> without_the_unlikeliest(List<point_based::Likelihood> cells) {
    constexpr double min_probability = error / (4 * static_cast<double>(max_combinations));
    double left_out = 0;
    erase_if(cells, [&](const point_based::Likelihood& cell) {
      if (cell.probability > min_probability) return false;
      left_out += cell.probability;
      return true;
    });
    const auto is_less_likely = [](const auto& one, const auto& other) { return one.probability < other.probability; };
    std::max_element(cells.begin(), cells.end(), is_less_likely)->probability += left_out;
    return cells;
  }

  List<NumberGrid> grids_;                             // by gauge
  List<List<point_based::Likelihood>> cells_of_;  // by report
  std::size_t observations_ = 0;
  std::size_t max_cells_ = 1;
};

}
