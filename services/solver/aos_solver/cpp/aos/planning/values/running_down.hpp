// What of a state only runs one way, such as a battery: it makes no place new, and no test wins by it.
#pragma once

#include "aos/base/mixed.hpp"
#include "aos/model/values.hpp"
#include "aos/planning/values/leaf_cells.hpp"
#include "aos/planning/values/random_walk.hpp"

namespace aos {

template <class Model>
class RunningDown {
 public:
  using State = typename Model::State;

  // Finds it by random walks from the belief.
  void find(const Belief<Model>& belief, Sampler& random) {
    cells_.prepare(belief, random);
    first_ = belief.particles().front().state;
    const List<PlacedNumber> numbers = numbers_of(*first_);
    List<Trend> of_cells(cells_.size()), of_numbers(numbers.size());
    List<std::uint64_t> cells_before(cells_.size());
    cell_.resize(cells_.size());
    int taken = 0;
    RandomWalk<Model>{}.explore(belief, walks, longest, random, [&](const State& before, const State& after) {
      ++taken;
      cells_.write(before, cells_before.data());
      cells_.write(after, cell_.data());
      for (std::size_t c = 0; c < cell_.size(); ++c) of_cells[c].note(static_cast<double>(static_cast<std::int64_t>(cell_[c] - cells_before[c])));
      for (std::size_t n = 0; n < numbers.size(); ++n) of_numbers[n].note(numbers[n].of(Model::bytes_of(after)) - numbers[n].of(Model::bytes_of(before)));
    });
    runs_.clear();
    for (const Trend& trend : of_cells) runs_.push_back(trend.only_runs(taken));
    lasts_.assign(Model::state_bytes(), true);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      if (!of_numbers[n].only_runs(taken)) continue;
      std::fill_n(lasts_.begin() + numbers[n].offset, numbers[n].leaf.size, false);
    }
  }

  // Lets what runs down be what it was at first.
  void set_back(State& state) const {
    for (std::size_t i = 0; i < lasts_.size(); ++i) {
      if (!lasts_[i]) Model::bytes_of(state)[i] = Model::bytes_of(*first_)[i];
    }
  }

  // A number for all of a state that does not run down.
  std::uint64_t place_of(const State& state) {
    cells_.write(state, cell_.data());
    std::uint64_t key = Model::ending(state) == Ending::running ? 1 : 0;
    for (std::size_t c = 0; c < cell_.size(); ++c) key = runs_[c] ? key : mixed(key, cell_[c]);
    return key;
  }
  std::uint64_t place_of(const List<State>& states) {
    std::uint64_t key = 0;
    for (const State& state : states) key = mixed(key, place_of(state));
    return key;
  }
  // The same number for states that do not differ, but for what runs down.
  std::uint64_t all_else_of(const State& state) const {
    std::uint64_t key = 0;
    for (std::size_t i = 0; i < lasts_.size(); ++i) key = lasts_[i] ? mixed(key, std::to_integer<std::uint64_t>(Model::bytes_of(state)[i])) : key;
    return key;
  }
  // Whether two states differ, but for what runs down.
  bool differ(const State& one, const State& other) const {
    if (are_alike<Model>(one, other)) return false;
    const std::byte* const left = Model::bytes_of(one);
    const std::byte* const right = Model::bytes_of(other);
    for (std::size_t i = 0; i < lasts_.size(); ++i) {
      if (lasts_[i] && left[i] != right[i]) return true;
    }
    return false;
  }

 private:
  static constexpr int walks = 50;
  static constexpr int longest = 20;

  struct Trend {
    int ups = 0;
    int downs = 0;
    void note(double change) {
      ups += change > 0;
      downs += change < 0;
    }
    bool only_runs(int taken) const { return std::min(ups, downs) == 0 && 2 * std::max(ups, downs) > taken; }
  };

  static List<PlacedNumber> numbers_of(const State& state) {
    List<PlacedNumber> numbers;
    for_each_number<Model>(state, [&](const std::string&, const PlacedNumber& number) { numbers.push_back(number); });
    return numbers;
  }

  std::optional<State> first_;
  LeafCells<Model> cells_;
  List<std::uint64_t> cell_;  // of the state that is looked at
  std::vector<bool> runs_;           // by cell
  std::vector<bool> lasts_;          // by byte of a state
};

}
