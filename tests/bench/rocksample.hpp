// RockSample(7, 8), as in deploy/bundles/bench/rocksample-7-8, with the same knowledge for play-outs.
#pragma once

#ifdef __BMI2__
#include <immintrin.h>
#endif

#include <cmath>

#include "problem.hpp"
#include "random.hpp"

namespace bench {

struct RockSample {
  static constexpr const char* name = "rocksample-7-8";
  static constexpr int size = 7;
  static constexpr int rocks = 8;
  static constexpr int action_count = rocks + 5;  // check each rock, north, east, south, west, sample
  static constexpr int observation_count = 2;
  static constexpr int depth = 90;
  static constexpr double discount = 0.95;
  static constexpr double exploration = 20;
  static constexpr bool has_knowledge = true;
  enum Action : int { north = rocks, east, south, west, sample };

  static constexpr std::array<int, rocks> rock_x{2, 0, 3, 6, 2, 3, 5, 1};
  static constexpr std::array<int, rocks> rock_y{0, 1, 1, 3, 4, 4, 5, 6};

  // Sets of rocks have bit i for rock i. What is learnt: good less bad reports of each rock, from -2 to 2, and the rocks
  // not yet sampled, of these the ones that may yet be good and the ones that look good.
  struct State {
    std::uint8_t cell = 3 * size;
    std::uint8_t good = 0;
    std::uint8_t unsampled = 0xff, promising = 0xff, looking_good = 0;
    std::array<std::int8_t, rocks> worth{};
  };

  static State start(Random& random) {
    State state;
    state.good = static_cast<std::uint8_t>(random.bits() >> 56);
    return state;
  }

  static Outcome step(State& state, int action, Random& random) {
    if (action < rocks) return check(state, action, random);
    if (action == sample) return take_sample(state);
    if (!(cells[state.cell].ways >> action & 1)) return {-100, 0, false};
    if (action == east && state.cell % size == size - 1) return {10, 0, true};
    constexpr std::array<std::int8_t, 4> change{size, 1, -size, -1};
    state.cell = static_cast<std::uint8_t>(state.cell + change[action - north]);
    return {};
  }

  static int legal_action(const State& state, Random& random) {
    return drawn_of(cells[state.cell].ways | ((1u << rocks) - 1), random);
  }

  static int promising_action(const State& state, Random& random) {
    const Cell& here = cells[state.cell];
    if (state.looking_good & here.rock) return sample;
    const unsigned near = state.promising & ~state.looking_good & here.rocks_near;
    if (near) return drawn_of(near, random);
    const auto goes_north = static_cast<unsigned>((state.promising & here.rocks_to_north) != 0);
    const auto goes_south = static_cast<unsigned>((state.promising & here.rocks_to_south) != 0);
    if (!(goes_north | goes_south)) return east;
    return drawn_of(goes_north << north | goes_south << south, random);
  }

 private:
  struct Cell {
    std::uint8_t rock = 0;  // the set of the rock here, if any
    std::uint8_t rocks_near = 0;  // not more than 2 away
    std::uint8_t rocks_to_north = 0, rocks_to_south = 0;  // in the same column
    std::uint16_t ways = 0;  // the legal actions other than checks
    std::array<std::uint32_t, rocks> true_report{};  // thresholds
  };
  static const std::array<Cell, size * size> cells;

  static std::array<Cell, size * size> all_cells() {
    std::array<Cell, size * size> all{};
    for (int number = 0; number < size * size; ++number) {
      const int x = number % size, y = number / size;
      Cell& cell = all[static_cast<std::size_t>(number)];
      cell.ways = static_cast<std::uint16_t>((y < size - 1) << north | 1 << east | (y > 0) << south | (x > 0) << west);
      for (int rock = 0; rock < rocks; ++rock) {
        const int dx = rock_x[rock] - x, dy = rock_y[rock] - y;
        const auto bit = static_cast<std::uint8_t>(1 << rock);
        if (dx == 0 && dy == 0) {
          cell.rock = bit;
          cell.ways |= 1 << sample;
        }
        if (dx * dx + dy * dy <= 4) cell.rocks_near |= bit;
        if (dx == 0 && dy > 0) cell.rocks_to_north |= bit;
        if (dx == 0 && dy < 0) cell.rocks_to_south |= bit;
        const double accuracy = (1 + std::pow(2.0, -std::hypot(dx, dy) / 20)) / 2;
        cell.true_report[rock] = accuracy < 1 ? threshold(accuracy) : 0xffffffffu;
      }
    }
    return all;
  }

  static Outcome check(State& state, int rock, Random& random) {
    const bool is_true = random.flag(cells[state.cell].true_report[rock]);
    const bool reports_good = (state.good >> rock & 1) == is_true;
    const auto bit = static_cast<std::uint8_t>(1 << rock);
    if (state.unsampled & bit) {
      int worth = state.worth[rock] + (reports_good ? 1 : -1);
      worth = worth > 2 ? 2 : worth < -2 ? -2 : worth;
      state.worth[rock] = static_cast<std::int8_t>(worth);
      state.promising = static_cast<std::uint8_t>((state.promising & ~bit) | (worth >= 0) << rock);
      state.looking_good = static_cast<std::uint8_t>((state.looking_good & ~bit) | (worth > 0) << rock);
    }
    return {0, reports_good, false};
  }

  static Outcome take_sample(State& state) {
    const std::uint8_t rock = cells[state.cell].rock;
    if (!rock) return {-100, 0, false};
    const float reward = state.good & rock ? 10.0f : -10.0f;
    const auto others = static_cast<std::uint8_t>(~rock);
    state.good &= others;
    state.unsampled &= others;
    state.promising &= others;
    state.looking_good &= others;
    return {reward, 0, false};
  }

  // One of the set bits, each as likely as the others.
  static int drawn_of(unsigned set, Random& random) {
    unsigned skipped = random.below(static_cast<unsigned>(std::popcount(set)));
#ifdef __BMI2__
    return std::countr_zero(_pdep_u32(1u << skipped, set));
#else
    for (; skipped > 0; --skipped) set &= set - 1;
    return std::countr_zero(set);
#endif
  }
};

inline const std::array<RockSample::Cell, RockSample::size * RockSample::size> RockSample::cells = all_cells();

}
