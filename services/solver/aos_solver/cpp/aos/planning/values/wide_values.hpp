// The fully observable (MDP) values of models with up to eight million states, from which POMCP counts. A state has no more than
// its distinct outcomes (compact_model.hpp), and draws that shape only what is observed are skipped. Random walks tell beforehand
// whether the list, which takes some seconds, is worth beginning.
#pragma once

#include <bitset>

#include "aos/base/progress.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/listed/state_lister.hpp"
#include "aos/planning/listed/state_numbers.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/random_walk.hpp"
#include "aos/planning/values/state_values.hpp"
#include "aos/planning/values/value_constants.hpp"
#include "numbers/compact_model.hpp"

namespace aos {

// Outcomes are counted in words of four bytes.
inline constexpr ListLimits wide_limits{
    .states = 8'000'000, .bytes = std::size_t{256} << 20, .outcomes = std::size_t{100} << 20, .work = 80'000'000};

template <class Model>
class WideValues final : public StateValues<Model> {
 public:
  using State = typename Model::State;

  explicit WideValues(const ListLimits& limits = wide_limits) : lister_(limits) {}

  // Computes the values of all states that can be reached from the first belief. Returns whether they can be used.
  bool prepare(const Belief<Model>& belief, int horizon) {
    if (has_tried_) return !values_.empty();
    has_tried_ = true;
    if (Model::action_count() == 0) return false;
    lister_.draws().skip_sensing(true);
    lister_.draws().report_to(&ignored_numbers);
    for (int action = 0; action < Model::action_count(); ++action) {
      if (!is_like_the_one_before(action)) actions_.push_back(action);
    }
    comes_to_an_end([&] {
      if (!is_affordable(belief, horizon)) return;
      list(belief);
      values_ = rows_.values(Model::discount, horizon);
    });
    rows_ = {};
    if (values_.empty()) {
      *this = WideValues{lister_.limits()};
      has_tried_ = true;
      return false;
    }
    highest_ = *std::ranges::max_element(values_);
    return true;
  }

  std::size_t states() const { return values_.size(); }

  // By one step of each action, all under the same luck.
  void advantages(const State& state, double* worths, Sampler& random) const override {
    const double now = value(state, 1);
    const Sampler luck{random.bits()};
    for (int action = 0; action < Model::action_count(); ++action) {
      worths[action] = is_like_the_one_before(action) ? worths[action - 1] : this->stepped_value(state, action, 2, luck) - now;
    }
  }

  // Does not depend on `left` above 0. A state that was not listed has the highest value.
  double value(const State& state, int left) const override {
    if (left <= 0) return 0;
    const std::uint32_t number = lister_.numbers().find(state);
    return number == no_state ? highest_ : values_[number];
  }

 private:
  static constexpr std::uint32_t states_of_block = 16;

  // A way on from a state.
  struct Path {
    State next;
    double probability;
    bool stays;  // in the same state
  };
  // The paths of an action, up to `end`.
  struct Row {
    std::size_t end;
    float reward;
  };

  // Whether the outcomes of an action, without what is observed, are those of the action before.
  static bool is_like_the_one_before(int action) {
    const int skill = Model::skill_of(action);
    return action > 0 && Model::skill_of(action - 1) == skill && Model::has_alike_groundings(skill);
  }

  // --- is it worth beginning?

  // Random walks tell how many values each byte of a running state takes. Their combinations are an estimate of the number
  // of states, since walks may miss values, and since some combinations may not occur. The limits of a list hold anyway.
  bool is_affordable(const Belief<Model>& belief, int horizon) {
    Sampler random{1};  // its own, so that a look in vain changes no decision
    RandomWalk<Model> walk;
    List<std::bitset<256>> values(Model::state_bytes());
    List<State> priced;
    const std::size_t work_of_one = 1 + Model::state_bytes() / 64;
    std::size_t work = 0;
    for (std::size_t walks = 0; walks < looked_at && work < max_looking_work; ++walks) {
      if (walks % states_between_looks == 0) progress::tell("walking at random", walks, looked_at);
      State state = belief.sample(random);
      const int steps = random.below(horizon);
      work += work_of_one * (1 + static_cast<std::size_t>(walk.take(state, steps, random)));
      if (Model::ending(state) != Ending::running) continue;
      for (std::size_t i = 0; i < values.size(); ++i) values[i].set(std::to_integer<std::size_t>(Model::bytes_of(state)[i]));
      if (priced.size() < priced_states) priced.push_back(state);
    }
    const double states = combinations(values);
    if (priced.empty() || states > static_cast<double>(lister_.limits().states)) return false;
    for (const State& state : priced) {
      for (const int action : actions_) lister_.walk(state, action, [](const State&, const Step&, double) {});
    }
    return states * static_cast<double>(lister_.work()) / static_cast<double>(priced.size()) <=
           static_cast<double>(lister_.limits().work);
  }

  // How many combinations of these values there are, without those of irrelevant variables.
  static double combinations(List<std::bitset<256>>& values) {
    for (const ByteRange& range : Model::irrelevant()) {
      for (std::size_t i = 0; i < range.size; ++i) values[range.offset + i].reset();
    }
    double product = 1;
    for (const auto& of_byte : values) product *= static_cast<double>(std::max<std::size_t>(of_byte.count(), 1));
    return product;
  }

  // --- the list

  // Goes through blocks of states: the places of their next states in memory are known some time before these are added.
  void list(const Belief<Model>& belief) {
    lister_.add_states_of(belief);
    const StateNumbers<Model>& numbers = lister_.numbers();
    for (std::uint32_t first = 0; first < numbers.size();) {
      const auto last = static_cast<std::uint32_t>(std::min<std::size_t>(first + states_of_block, numbers.size()));
      block_.clear();
      block_rows_.clear();
      for (std::uint32_t number = first; number < last; ++number) walk_actions(number);
      add_block(first, last);
      first = last;
      if (rows_.words() > lister_.limits().outcomes) throw NotEnumerable{"there are too many outcomes to list"};
    }
  }

  void walk_actions(std::uint32_t number) {
    if (number % states_between_looks == 0) progress::tell("listing states without observations", number, lister_.numbers().size());
    const State state = lister_.numbers()[number];
    for (const int action : actions_) {
      const double reward = lister_.walk(state, action, [&](const State& next, const Step&, double probability) {
        const bool stays = lister_.numbers().are_same(next, state);
        if (!stays) lister_.numbers().prefetch(next);
        block_.push_back({next, probability, stays});
      });
      block_rows_.push_back({block_.size(), static_cast<float>(reward)});
    }
  }

  void add_block(std::uint32_t first, std::uint32_t last) {
    std::size_t at = 0;
    auto row = block_rows_.begin();
    for (std::uint32_t number = first; number < last; ++number) {
      rows_.begin_state();
      for (std::size_t action = 0; action < actions_.size(); ++action, ++row) {
        outcomes_.clear();
        for (; at < row->end; ++at) {
          outcomes_.push_back({block_[at].stays ? number : lister_.add(block_[at].next), block_[at].probability});
        }
        rows_.add_row(outcomes_, row->reward);
      }
    }
  }

  bool has_tried_ = false;
  StateLister<Model> lister_;
  List<float> values_;
  float highest_ = 0;
  // While listing:
  List<int> actions_;  // one of those that are alike
  List<Path> block_;   // of the states of a block, action by action
  List<Row> block_rows_;
  CompactModel rows_;
  List<CompactModel::Outcome> outcomes_;
};

}
