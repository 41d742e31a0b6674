// Numbers told by the cells of a grid: number_reports.hpp, number_grid.hpp, number_cells.hpp, and search over them.
#include "aos/planning/listed/number_cells.hpp"

#include <numeric>

#include "check.hpp"
#include "point_based/online.hpp"

namespace units::number_cells_tests {

namespace point_based = aos::point_based;
using aos::NumberCells;
using aos::NumberReports;

bool never() { return false; }

constexpr int skill = 0;

std::uint32_t normal(NumberReports& reports, double mean, double deviation, std::uint32_t response = 0) {
  reports.begin();
  reports.take(aos::number_key(0, 0), aos::Normal{mean, deviation});
  return reports.add(skill, response);
}

// The likelihoods of each report by itself.
point_based::Rows<point_based::Likelihood> each(const NumberReports& reports) {
  point_based::Rows<point_based::Likelihood> rows;
  rows.first.push_back(0);
  for (std::uint32_t report = 0; report < reports.reports().size(); ++report) {
    rows.elements.push_back({report, 1.0});
    rows.first.push_back(rows.elements.size());
  }
  return rows;
}

double sum_of(const point_based::Rows<point_based::Likelihood>& rows, std::size_t row) {
  return std::accumulate(rows.begin(row), rows.end(row), 0.0,
                         [](double sum, const auto& likelihood) { return sum + likelihood.probability; });
}

TEST("Equal reports have one number, whatever the order of their numbers") {
  NumberReports reports;
  const std::uint32_t first = normal(reports, 1, 2);
  EXPECT_EQUAL(normal(reports, 1, 2), first);
  EXPECT(normal(reports, 1, 3) != first);
  EXPECT(normal(reports, 1, 2, 1) != first);
  reports.begin();
  reports.take(aos::number_key(1, 0), aos::Bernoulli{0.5});
  reports.take(aos::number_key(0, 0), aos::Normal{1, 2});
  const std::uint32_t both = reports.add(skill, 0);
  reports.begin();
  reports.take(aos::number_key(0, 0), aos::Normal{1, 2});
  reports.take(aos::number_key(1, 0), aos::Bernoulli{0.5});
  EXPECT_EQUAL(reports.add(skill, 0), both);
}

TEST("The probabilities of cells sum to 1, and are those of draws") {
  const double weights[] = {0.2, 0.1, 0.4};
  NumberReports reports;
  for (const double level : {0.0, 1.0, 2.5}) {
    reports.begin();
    reports.take(aos::number_key(0, 0), aos::Normal{level, 0.5 + level});
    reports.take(aos::number_key(1, 0), aos::Uniform{level, 3});
    reports.take(aos::number_key(2, 0), aos::Bernoulli{0.3 * level});
    reports.take(aos::number_key(3, 0), aos::Discrete{{weights[0] * level, weights[1], weights[2] / 2}});
    reports.add(skill, 0);
  }
  NumberCells cells;
  EXPECT_EQUAL(cells.choose(reports), "");
  EXPECT(cells.max_cells() > 16 && cells.max_cells() <= NumberCells::max_combinations);
  const auto rows = cells.by_cells(each(reports));
  for (std::size_t row = 0; row < 3; ++row) EXPECT_NEAR(sum_of(rows, row), 1.0, NumberCells::error);
}

TEST("The grid of two coins is the coins, and their cells have the probabilities of both") {
  NumberReports reports;
  for (const double odds : {0.1, 0.8}) {
    reports.begin();
    reports.take(aos::number_key(0, 0), aos::Bernoulli{odds});
    reports.take(aos::number_key(0, 1), aos::Bernoulli{odds / 2});
    reports.add(skill, 0);
  }
  NumberCells cells;
  EXPECT_EQUAL(cells.choose(reports), "");
  EXPECT_EQUAL(cells.max_cells(), 4u);
  const auto rows = cells.by_cells(each(reports));
  EXPECT_EQUAL(rows.elements.size(), 8u);
  EXPECT_NEAR(rows.begin(0)[0].probability, 0.9 * 0.95, 1e-15);
  EXPECT_NEAR(rows.begin(1)[3].probability, 0.8 * 0.4, 1e-15);
}

TEST("A number that tells nothing has one cell") {
  NumberReports reports;
  normal(reports, 1, 2, 0);
  normal(reports, 1, 2, 1);
  NumberCells cells;
  EXPECT_EQUAL(cells.choose(reports), "");
  EXPECT_EQUAL(cells.max_cells(), 1u);
  EXPECT_EQUAL(cells.observations(), 2u);
}

TEST("Too many numbers at once are refused, and say so") {
  NumberReports reports;
  for (const double level : {0.0, 1.0}) {
    reports.begin();
    for (std::uint32_t beam = 0; beam < 9; ++beam) reports.take(aos::number_key(0, beam), aos::Normal{level, 1});
    reports.add(skill, 0);
  }
  EXPECT(NumberCells{}.choose(reports).starts_with("9 numbers are observed at once"));
}

// A tiger is behind one of two doors; what is heard of it is a number of normal noise around -1 or 1. Listening costs
// 1, the door of the tiger 100; the other earns 10. Doors end the mission.
point_based::FlatModel doors(NumberReports& reports) {
  point_based::FlatModel model;
  model.states = 2;
  model.actions = 3;
  model.discount = 0.95;
  model.horizon = 20;
  model.outcomes.first = model.likelihoods.first = {0};
  for (std::uint32_t side = 0; side < 2; ++side) {
    model.likelihoods.elements.push_back({normal(reports, side == 0 ? -1 : 1, 1.0), 1.0});
    model.likelihoods.first.push_back(side + 1);
    model.outcomes.elements.push_back({side, side, 1.0});
    for (int action = 0; action < 3; ++action) model.outcomes.first.push_back(side + 1);
    for (const double reward : {-1.0, side == 0 ? -100.0 : 10.0, side == 1 ? -100.0 : 10.0}) model.rewards.push_back(reward);
  }
  model.starts = {{1.0, {{0, 0.5}, {1, 0.5}}}};
  return model;
}

double value_over_cells(std::size_t max) {
  NumberReports reports;
  point_based::FlatModel model = doors(reports);
  NumberCells cells;
  EXPECT_EQUAL(cells.choose(reports, max), "");
  EXPECT(cells.max_cells() <= max);
  model.likelihoods = cells.by_cells(model.likelihoods);
  model.observations = cells.observations();
  point_based::OnlineSarsop search{model};
  search.move_to(model.starts.front().belief);
  search.improve(500'000'000, never);
  const auto [lower, upper] = search.bounds();
  EXPECT_NEAR(lower, upper, 0.01);
  return lower;
}

// By value iteration over the log-odds of the tiger's place, to which a number z adds 2 z.
double value_of_numbers() {
  constexpr int points = 1501, steps = 161;
  constexpr double spacing = 30.0 / (points - 1);
  const auto odds_of = [&](int point) { return -15 + spacing * point; };
  aos::List<double> value(points, 0.0), listened(points);
  for (int decision = 0; decision < 20; ++decision) {
    const auto at = [&](double odds) {
      const double place = std::clamp((odds + 15) / spacing, 0.0, points - 1.001);
      const auto point = static_cast<std::size_t>(place);
      return value[point] + (place - static_cast<double>(point)) * (value[point + 1] - value[point]);
    };
    for (int point = 0; point < points; ++point) {
      const double right = 1 / (1 + std::exp(-odds_of(point)));
      double later = 0, total = 0;
      for (int step = 0; step < steps; ++step) {
        const double noise = -6 + 12.0 * step / (steps - 1);
        const double weight = std::exp(-0.5 * noise * noise);
        total += weight;
        const double if_right = at(odds_of(point) + 2 * (noise + 1));
        const double if_left = at(odds_of(point) + 2 * (noise - 1));
        later += weight * (right * if_right + (1 - right) * if_left);
      }
      listened[static_cast<std::size_t>(point)] = -1 + 0.95 * later / total;
    }
    for (int point = 0; point < points; ++point) {
      const double right = 1 / (1 + std::exp(-odds_of(point)));
      value[static_cast<std::size_t>(point)] =
          std::max(10 - 110 * std::min(right, 1 - right), listened[static_cast<std::size_t>(point)]);
    }
  }
  return listened[points / 2];
}

TEST("What is earned over cells is below what numbers are worth, near it with many, and no less with more") {
  const double best = value_of_numbers();
  EXPECT_NEAR(best, 5.47, 0.01);
  double before = -1e9;
  for (const std::size_t max : {2u, 3u, 5u, 8u, 256u}) {
    const double value = value_over_cells(max);
    EXPECT(value <= best + 2e-3);
    EXPECT(value >= before - 0.01);
    before = value;
  }
  EXPECT(before >= 0.95 * best);
}

}
