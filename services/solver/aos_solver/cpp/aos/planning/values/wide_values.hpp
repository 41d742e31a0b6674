// The fully observable (MDP) values of models with up to eight million states. POMCP counts from them.
//
// The state space holds observations, too, and is full with 400,000 states. Here a state has no more than its
// distinct outcomes. Draws that shape only what is observed are skipped, and of actions with the same outcomes only the best
// one is kept. Values are computed in sweeps that go through the states in turn from either end, each
// value from the newest others (Gauss and Seidel).
//
// Listing takes some ten seconds, once. Random walks tell beforehand whether it is worth beginning, by how many values
// each variable takes.
#pragma once

#include <algorithm>
#include <bit>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/fault.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/base/progress.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/step.hpp"
#include "aos/planning/listed/state_numbers.hpp"
#include "aos/planning/values/mdp_values.hpp"
#include "aos/planning/values/random_walk.hpp"
#include "aos/planning/values/state_values.hpp"

namespace aos {

struct WideLimits {
  std::size_t states = 8'000'000;
  std::size_t bytes = std::size_t{256} << 20;   // of states
  std::size_t words = std::size_t{100} << 20;   // of four bytes, of outcomes
  std::size_t work = 80'000'000;               // in draws and copies of 64 bytes
};
// Before a listing begins:
inline constexpr std::size_t looked_at = 20'000;         // walks
inline constexpr std::size_t max_looking_work = 600'000;  // in steps and copies of 64 bytes
inline constexpr std::size_t priced_states = 100;

template <class Model>
class WideValues final : public StateValues<Model> {
 public:
  using State = typename Model::State;

  explicit WideValues(WideLimits limits = {}) : limits_(limits) {}

  // Computes the values of all states that can be reached from the first belief. Returns whether they can be used.
  bool prepare(const Belief<Model>& belief, int horizon) {
    if (has_tried_) return !values_.empty();
    has_tried_ = true;
    if (Model::action_count() == 0) return false;
    draws_.skip_sensing(true);
    draws_.report_to(&ignored_numbers);
    for (int action = 0; action < Model::action_count(); ++action) {
      if (!is_like_the_one_before(action)) actions_.push_back(action);
    }
    try {
      if (is_affordable(belief, horizon) && list(belief) && iterate(horizon)) return true;
    } catch (const NotEnumerable&) {
    } catch (const ModelFault&) {
    }
    blame::at(0);
    *this = WideValues{limits_};
    has_tried_ = true;
    return false;
  }

  std::size_t states() const { return values_.size(); }

  // By one step of each action, all under the same luck.
  void advantages(const State& state, double* worths, Sampler& random) const override {
    const double now = value(state, 1);
    const Sampler luck{random.bits()};
    int stepped = 0;
    for (int action = 0; action < Model::action_count(); ++action) {
      if (is_like_the_one_before(action)) {
        worths[action] = worths[stepped];
        continue;
      }
      stepped = action;
      State next = state;
      Sampler draws = luck;
      const Step step = Model::step(next, action, draws);
      const bool goes_on = Model::ending(next) == Ending::running;
      worths[action] = step.reward + (goes_on ? Model::discount * value(next, 1) : 0) - now;
    }
  }

  // Does not depend on `left` above 0. A state that was not listed has the highest value.
  double value(const State& state, int left) const override {
    if (left <= 0) return 0;
    const std::uint32_t number = numbers_.find(state);
    return number == no_state ? highest_ : values_[number];
  }

 private:
  // A row is a reward and its outcomes. Its first word is the number of its reward, shifted, the number of outcomes, and
  // whether there is one that is certain, which then has no probability.
  static constexpr std::uint32_t outcome_bits = 8;
  static constexpr std::uint32_t max_outcomes = (1u << (outcome_bits - 1)) - 1;
  static constexpr std::uint32_t max_rewards = 1u << (32 - outcome_bits);
  static constexpr double certain = 1 - 1e-9;

  struct Outcome {
    std::uint32_t next;
    double probability;
  };

  // Whether the outcomes of an action, without what is observed, are those of the action before.
  static bool is_like_the_one_before(int action) {
    const int skill = Model::skill_of(action);
    return action > 0 && Model::skill_of(action - 1) == skill && Model::has_alike_groundings(skill);
  }

  // --- is it worth beginning? ------------------------------------------------------------------------

  // Random walks tell how many values each byte of a running state takes. Their combinations are an estimate of the number
  // of states, since walks may miss values, and since some combinations may not occur. The limits of a list hold anyway.
  bool is_affordable(const Belief<Model>& belief, int horizon) {
    Sampler random{1};  // its own, so that a look in vain changes no decision
    RandomWalk<Model> walk;
    std::vector<std::bitset<256>> values(Model::state_bytes());
    std::vector<State> priced;
    const std::size_t work_of_one = 1 + Model::state_bytes() / 64;
    std::size_t work = 0;
    for (std::size_t walks = 0; walks < looked_at && work < max_looking_work; ++walks) {
      State state = belief.sample(random);
      walk.start();
      for (int left = random.below(horizon); left > 0 && Model::ending(state) == Ending::running; --left) {
        Model::step(state, walk.next(state, random), random);
        work += work_of_one;
      }
      work += work_of_one;
      if (Model::ending(state) != Ending::running) continue;
      for (std::size_t i = 0; i < values.size(); ++i) values[i].set(std::to_integer<std::size_t>(Model::bytes_of(state)[i]));
      if (priced.size() < priced_states) priced.push_back(state);
    }
    const double states = combinations(values);
    if (priced.empty() || states > static_cast<double>(limits_.states)) return false;
    for (const State& state : priced) {
      for (const int action : actions_) outcomes_of(state, action, [](const State&) { return no_state; });
    }
    return states * static_cast<double>(work_) / static_cast<double>(priced.size()) <= static_cast<double>(limits_.work);
  }

  // How many combinations of these values there are, without those of irrelevant variables.
  static double combinations(std::vector<std::bitset<256>>& values) {
    for (const ByteRange& range : Model::irrelevant()) {
      for (std::size_t i = 0; i < range.size; ++i) values[range.offset + i].reset();
    }
    double product = 1;
    for (const auto& of_byte : values) product *= static_cast<double>(std::max<std::size_t>(of_byte.count(), 1));
    return product;
  }

  // --- outcomes --------------------------------------------------------------------------------------

  bool list(const Belief<Model>& belief) {
    work_ = 0;
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) == Ending::running) add(state);
    }
    // If a sampled belief has most of its states only once, there are more.
    if (belief.is_drawn() && 2 * numbers_.size() > belief.particles().size()) return false;
    for (std::uint32_t number = 0; number < numbers_.size(); ++number) {
      if (number % states_between_looks == 0) progress::tell("listing states without observations", number, numbers_.size());
      add_rows(number);
    }
    first_.push_back(words_.size());
    return numbers_.size() > 0;
  }

  std::uint32_t add(const State& state) {
    const std::uint32_t number = numbers_.add(state);
    if (number >= limits_.states || numbers_.bytes() > limits_.bytes) throw NotEnumerable{"there are too many states"};
    return number;
  }

  // Fills `outcomes_` with the states after a step in which the mission goes on. Returns the expected reward.
  template <class NumberOf>
  double outcomes_of(const State& state, int action, NumberOf&& number_of) {
    double reward = 0;
    outcomes_.clear();
    const auto run = [&](Enumerator& path) {
      work_ += work_of_step(path, Model::state_bytes());
      if (work_ > limits_.work) throw NotEnumerable{"there are too many outcomes"};
      next_ = state;
      step_ = Model::step(next_, action, path);
    };
    draws_.for_nearly_each_path(run, [&](Enumerator& path) {
      reward += path.probability() * step_.reward;
      if (Model::ending(next_) == Ending::running) outcomes_.push_back({number_of(next_), path.probability()});
    });
    return reward;
  }

  void add_rows(std::uint32_t number) {
    const State state = numbers_[number];
    const std::size_t first = words_.size();
    first_.push_back(static_cast<std::uint32_t>(first));
    for (const int action : actions_) {
      const auto number_of = [&](const State& next) { return numbers_.are_same(next, state) ? number : add(next); };
      const double reward = outcomes_of(state, action, number_of);
      merge_outcomes();
      add_row(first, static_cast<float>(reward));
    }
    if (words_.size() > limits_.words) throw NotEnumerable{"there are too many outcomes"};
  }

  void merge_outcomes() {
    if (outcomes_.size() < 2) return;
    std::sort(outcomes_.begin(), outcomes_.end(), [](const auto& left, const auto& right) { return left.next < right.next; });
    std::size_t kept = 0;
    for (std::size_t i = 1; i < outcomes_.size(); ++i) {
      if (outcomes_[i].next == outcomes_[kept].next) {
        outcomes_[kept].probability += outcomes_[i].probability;
      } else {
        outcomes_[++kept] = outcomes_[i];
      }
    }
    outcomes_.resize(kept + 1);
  }

  // Adds `outcomes_` as a row of the state whose rows begin at `first`, or improves the reward of a row that is alike.
  void add_row(std::size_t first, float reward) {
    const bool is_certain = outcomes_.size() == 1 && outcomes_[0].probability > certain;
    if (outcomes_.size() > max_outcomes) throw NotEnumerable{"a step has too many outcomes"};
    row_.clear();
    row_.push_back(static_cast<std::uint32_t>(outcomes_.size() << 1 | (is_certain ? 1 : 0)));
    for (const Outcome& outcome : outcomes_) {
      row_.push_back(outcome.next);
      if (!is_certain) row_.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(outcome.probability)));
    }
    for (std::size_t at = first; at < words_.size(); at += length_at(at)) {
      if (!has_outcomes_of_row(at)) continue;
      if (rewards_[words_[at] >> outcome_bits] < reward) words_[at] = number_of_reward(reward) << outcome_bits | row_[0];
      return;
    }
    row_[0] |= number_of_reward(reward) << outcome_bits;
    words_.insert(words_.end(), row_.begin(), row_.end());
  }
  bool has_outcomes_of_row(std::size_t at) const {
    constexpr std::uint32_t kind = (1u << outcome_bits) - 1;
    return (words_[at] & kind) == row_[0] && std::equal(row_.begin() + 1, row_.end(), &words_[at] + 1);
  }
  std::size_t length_at(std::size_t at) const {
    const std::uint32_t count = words_[at] >> 1 & max_outcomes;
    return (words_[at] & 1) != 0 ? 2 : 1 + 2 * count;
  }
  std::uint32_t number_of_reward(float reward) {
    const auto [entry, is_new] = reward_numbers_.try_emplace(reward, static_cast<std::uint32_t>(rewards_.size()));
    if (is_new) rewards_.push_back(reward);
    if (rewards_.size() > max_rewards) throw NotEnumerable{"there are too many rewards"};
    return entry->second;
  }

  // --- values ----------------------------------------------------------------------------------------

  // Returns whether the values have settled after as many sweeps as there are decisions.
  bool iterate(int horizon) {
    const auto count = static_cast<std::uint32_t>(numbers_.size());
    values_.assign(count, 0);
    for (int sweep = 0; sweep < horizon; ++sweep) {
      progress::tell("computing values of states", static_cast<std::uint64_t>(sweep), static_cast<std::uint64_t>(horizon));
      float change = 0;
      float scale = 0;
      highest_ = -std::numeric_limits<float>::infinity();
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t number = sweep % 2 == 0 ? count - 1 - i : i;
        const float value = best_at(number);
        change = std::max(change, std::abs(value - values_[number]));
        scale = std::max(scale, std::abs(value));
        highest_ = std::max(highest_, value);
        values_[number] = value;
      }
      if (change <= settled_share * scale) return release();
    }
    return false;
  }

  float best_at(std::uint32_t number) const {
    const auto discount = static_cast<float>(Model::discount);
    float best = -std::numeric_limits<float>::infinity();
    for (std::size_t at = first_[number]; at < first_[number + 1]; at += length_at(at)) {
      float later = 0;
      if ((words_[at] & 1) != 0) {
        later = values_[words_[at + 1]];
      } else {
        for (std::size_t i = at + 1; i < at + length_at(at); i += 2) {
          later += std::bit_cast<float>(words_[i + 1]) * values_[words_[i]];
        }
      }
      best = std::max(best, rewards_[words_[at] >> outcome_bits] + discount * later);
    }
    return best;
  }

  // Frees what only the sweeps need.
  bool release() {
    words_ = {};
    first_ = {};
    return true;
  }

  WideLimits limits_;
  bool has_tried_ = false;
  StateNumbers<Model> numbers_;
  std::vector<float> values_;
  float highest_ = 0;
  // While computing:
  std::vector<int> actions_;  // one of those that are alike
  Enumerator draws_;
  State next_;  // to which the last run led
  Step step_;
  std::size_t work_ = 0;
  std::vector<Outcome> outcomes_;
  std::vector<std::uint32_t> row_;
  std::vector<std::uint32_t> words_;  // the rows of all states
  std::vector<std::uint32_t> first_;  // where the rows of each state begin, and the end
  std::vector<float> rewards_;
  std::unordered_map<float, std::uint32_t> reward_numbers_;
};

}  // namespace aos
