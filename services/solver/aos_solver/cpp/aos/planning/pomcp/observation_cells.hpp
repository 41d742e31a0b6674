// Observed numbers in a search tree, where no two simulations observe the same ones. The numbers after an action and a response
// fall into cells around drawn observations, into the nearest one in units of the distributions' spreads. The number of cells
// grows with the visits (progressive widening: Couetoux and others, 2011). The history of a cell has a proper belief, that after
// the cell in place of the numbers: what a policy over cells earns can be earned by numbers, too.
#pragma once

#include <unordered_map>

#include "aos/draws/observed_numbers.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/pomcp/pomcp_constants.hpp"

namespace aos {

class ObservationCells {
 public:
  struct Number {
    NumberKey key;
    double value;
    double spread;
  };
  // Draws the numbers that a step reports.
  class Drawn final : public NumberSink {
   public:
    explicit Drawn(Sampler& random) : random_(random) {}
    void take(NumberKey key, const Distribution& distribution) override {
      numbers.push_back({key, distribution.draw(random_), distribution.spread()});
    }

    List<Number> numbers;

   private:
    Sampler& random_;
  };

  void clear() {
    places_.clear();
    cells_ = 0;
  }

  // The observation that stands for a response and its numbers. `action` is the node of the action before.
  Observation cell(std::uint32_t action, Observation response, const Drawn& drawn) {
    if (drawn.numbers.empty()) return response;
    Place& place = places_[mixed(mixed(0, action), response)];
    ++place.visits;
    const Cell* nearest = nullptr;
    double min_distance = std::numeric_limits<double>::infinity();
    for (const Cell& cell : place.cells) {
      const double distance = squared_distance(cell, drawn, min_distance);
      if (distance >= min_distance) continue;
      min_distance = distance;
      nearest = &cell;
    }
    const double wanted = cells_of_one_visit * std::pow(static_cast<double>(place.visits), cell_widening);
    const bool is_new = nearest == nullptr || (place.cells.size() < wanted && cells_ < max_observation_cells);
    if (!is_new) return nearest->name;
    ++cells_;
    const auto name = mixed(response, place.cells.size() + 1);
    place.cells.push_back({static_cast<Observation>(name), drawn.numbers});
    return place.cells.back().name;
  }

 private:
  struct Cell {
    Observation name;
    List<Number> numbers;
  };
  struct Place {
    std::uint64_t visits = 0;
    List<Cell> cells;
  };

  // Infinite if other numbers were reported. From `limit` on the distance is not exact.
  static double squared_distance(const Cell& cell, const Drawn& drawn, double limit) {
    if (!std::ranges::equal(cell.numbers, drawn.numbers, {}, &Number::key, &Number::key)) return std::numeric_limits<double>::infinity();
    double sum = 0;
    for (std::size_t i = 0; i < cell.numbers.size() && sum < limit; ++i) {
      const double distance = (cell.numbers[i].value - drawn.numbers[i].value) / drawn.numbers[i].spread;
      sum += distance * distance;
    }
    return sum;
  }

  std::unordered_map<std::uint64_t, Place> places_;
  std::size_t cells_ = 0;
};

}
