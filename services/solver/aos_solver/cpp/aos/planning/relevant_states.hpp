// The reachable states of a model, told apart only by what matters for what is yet to be earned.
//
// Documents keep in a state what the robot has learnt, for their rollout policies; somebody who sees the state has no use
// for it, and without it far fewer states differ. No variable matters at first. In states on the way, values of the others
// are tried that random walks have come across; where a state then earns something else, or leads elsewhere, the variable
// matters from then on, and the states are told apart anew. It is tried in the first thousands of states, in fewer where
// steps have many outcomes, and in some of the later ones, so what hardly ever matters can be missed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <vector>

#include "aos/base/enumerator.hpp"
#include "aos/base/fault.hpp"
#include "aos/belief/belief.hpp"
#include "aos/model/values.hpp"

namespace aos {

inline constexpr std::size_t most_relevant_states = 400'000;
inline constexpr std::size_t most_relevant_bytes = std::size_t{100} << 20;  // of states
inline constexpr std::size_t most_relevant_branches = 8'000'000;
inline constexpr std::size_t most_relevant_work = 30'000'000;  // about a second's
inline constexpr std::size_t most_trying_work = 5'000'000;     // of it for trying other values, each time states are told apart
inline constexpr std::size_t tried_states = 2000;
inline constexpr std::size_t first_tried_states = 16;
inline constexpr int walked_states = 2000;
inline constexpr std::size_t most_examples = 4;

template <class Model>
class RelevantStates {
 public:
  using State = typename Model::State;
  struct Branch {
    std::uint32_t next;
    float probability;
  };
  static constexpr std::uint32_t none = 0xffffffffu;
  static constexpr std::size_t most_room = std::min(most_relevant_states, most_relevant_bytes / sizeof(State));

  RelevantStates() = default;
  // For somebody who does not see the state, so that what is observed matters, too.
  static RelevantStates by_observations() {
    RelevantStates states;
    states.observations_matter_ = true;
    return states;
  }

  // Adds what can be reached from a belief. Throws NotEnumerable where that is too much: in numbers of states and steps,
  // not in time, so that decisions can be repeated. Where most states of a belief were drawn once only, there are more.
  void reach_from(const Belief<Model>& belief) {
    work_ = 0;
    if (states_.empty()) ignore_everything(belief);
    while (true) {
      for (const auto& particle : belief.particles()) number_of(particle.state);
      if (belief.is_drawn() && 2 * size() > belief.particles().size()) throw NotEnumerable{"too many states"};
      if (explore()) return;
      states_.clear();
      keys_.clear();
      numbers_.clear();
      rewards_.clear();
      branch_ends_.clear();
      branches_.clear();
    }
  }

  std::size_t size() const { return states_.size(); }
  const State& operator[](std::uint32_t number) const { return states_[number]; }
  // By state and action; the branches of all pairs stand one after the other.
  const std::vector<float>& rewards() const { return rewards_; }
  const std::vector<std::size_t>& branch_ends() const { return branch_ends_; }
  const std::vector<Branch>& branches() const { return branches_; }

  // What has several values and does not matter.
  std::vector<Place> ignored() const {
    std::vector<Place> places;
    for (const Variable& variable : variables_) {
      if (!variable.matters) places.push_back(variable.place);
    }
    return places;
  }

  // Where an action leads if it can lead nowhere else, but to an end; else `none`.
  std::uint32_t only_next(std::uint32_t number, int action) const {
    const std::size_t pair = number * actions() + static_cast<std::size_t>(action);
    const std::size_t first = pair == 0 ? 0 : branch_ends_[pair - 1];
    return branch_ends_[pair] == first + 1 ? branches_[first].next : none;
  }

  // `none` for a state that cannot be reached.
  std::uint32_t find(const State& state) const { return numbers_[slot_of(key_of(state))]; }

 private:
  // What matters of a state: its first `words_` are in use.
  using Key = std::array<std::uint64_t, (sizeof(State) + 7) / 8>;
  using Signature = std::vector<double>;

  // A variable that has several values.
  struct Variable {
    Place place;
    std::vector<State> examples;  // with different values of it
    bool matters;
  };

  void ignore_everything(const Belief<Model>& belief) {
    mask_.fill(~std::uint64_t{0});
    variables_.clear();
    for (const Place& place : Model::places(belief.particles().front().state)) variables_.push_back({place, {}, false});
    Sampler random{1};
    State state = belief.sample(random);
    for (int i = 0; i < walked_states; ++i) {
      for (Variable& variable : variables_) add_example(variable, state);
      const bool starts_anew = Model::ending(state) != Ending::running || random.below(Model::horizon) == 0;
      if (starts_anew) state = belief.sample(random);
      if (!starts_anew) Model::step(state, random.below(Model::action_count()), random);
    }
    std::erase_if(variables_, [](const Variable& variable) { return variable.examples.size() == 1; });
    for (const Variable& variable : variables_) set_ignored(variable.place, true);
    find_words();
  }

  static void add_example(Variable& variable, const State& state) {
    if (variable.examples.size() == most_examples) return;
    for (const State& known : variable.examples) {
      if (is_same_at(variable.place, known, state)) return;
    }
    variable.examples.push_back(state);
  }

  static bool is_same_at(const Place& place, const State& left, const State& right) {
    return std::memcmp(reinterpret_cast<const std::byte*>(&left) + place.offset,
                       reinterpret_cast<const std::byte*>(&right) + place.offset, place.size) == 0;
  }
  void set_ignored(const Place& place, bool is_ignored) {
    std::memset(reinterpret_cast<std::byte*>(mask_.data()) + place.offset, is_ignored ? 0x00 : 0xff, place.size);
  }

  // Lists the words of which anything matters.
  void find_words() {
    words_ = 0;
    for (std::size_t word = 0; 8 * word < Model::state_bytes(); ++word) {
      if (mask_[word] != 0) word_[words_++] = word;
    }
  }

  Key key_of(const State& state) const {
    Key key;
    for (std::size_t i = 0; i < words_; ++i) {
      std::memcpy(&key[i], reinterpret_cast<const std::byte*>(&state) + 8 * word_[i], 8);
      key[i] &= mask_[word_[i]];
    }
    return key;
  }
  bool is_same(const Key& left, const Key& right) const {
    std::uint64_t difference = 0;
    for (std::size_t i = 0; i < words_; ++i) difference |= left[i] ^ right[i];
    return difference == 0;
  }
  std::uint64_t hash_of(const Key& key) const {
    std::uint64_t hash = 0;
    for (std::size_t i = 0; i < words_; ++i) hash = mixed(hash, key[i]);
    return hash;
  }
  // Open addressing, at most half full.
  std::size_t slot_of(const Key& key) const {
    std::size_t slot = hash_of(key) & (numbers_.size() - 1);
    while (numbers_[slot] != none && !is_same(keys_[numbers_[slot]], key)) slot = (slot + 1) & (numbers_.size() - 1);
    return slot;
  }

  std::uint32_t number_of(const State& state) {
    if (2 * states_.size() >= numbers_.size()) grow();
    const Key key = key_of(state);
    std::uint32_t& number = numbers_[slot_of(key)];
    if (number == none) {
      if (states_.size() == most_room) throw NotEnumerable{"too many states"};
      number = static_cast<std::uint32_t>(states_.size());
      states_.push_back(state);
      keys_.push_back(key);
    }
    return number;
  }

  void grow() {
    numbers_.assign(std::max<std::size_t>(4 * numbers_.size(), 256), none);
    for (std::size_t number = 0; number < keys_.size(); ++number) {
      numbers_[slot_of(keys_[number])] = static_cast<std::uint32_t>(number);
    }
  }

  // Returns false where states had to be told apart.
  bool explore() {
    Enumerator draws;
    trying_work_ = 0;
    for (std::size_t number = rewards_.size() / actions(); number < states_.size(); ++number) {
      // Early, too, since what is known to matter need not be tried again.
      if ((number == first_tried_states || number == tried_states) && tell_apart()) return false;
      const bool is_early = number < tried_states && trying_work_ < most_trying_work;
      if (is_early || number % tried_states == 0) try_variables(states_[number]);
      for (std::size_t action = 0; action < actions(); ++action) {
        double reward = 0;
        const std::size_t first = branches_.size();
        if (Model::ending(states_[number]) == Ending::running) {
          draws.for_each_path([&](Enumerator& path) {
            count_path(path);
            State next = states_[number];
            const Step step = Model::step(next, static_cast<int>(action), path);
            reward += path.probability() * step.reward;
            if (Model::ending(next) == Ending::running) add_branch(first, number_of(next), path.probability());
          });
        }
        rewards_.push_back(static_cast<float>(reward));
        branch_ends_.push_back(branches_.size());
      }
    }
    return !tell_apart();
  }

  void count_path(const Enumerator& path) {
    work_ += work_of_step(path, Model::state_bytes());
    if (work_ > most_relevant_work) throw NotEnumerable{"too many outcomes"};
  }

  void add_branch(std::size_t first, std::uint32_t next, double probability) {
    for (std::size_t branch = first; branch < branches_.size(); ++branch) {
      if (branches_[branch].next != next) continue;
      branches_[branch].probability += static_cast<float>(probability);
      return;
    }
    if (branches_.size() == most_relevant_branches) throw NotEnumerable{"too many outcomes"};
    branches_.push_back({next, static_cast<float>(probability)});
  }

  // Of each action: what it earns, and a number that tells where it leads, and by what observation if that matters.
  Signature signature_of(const State& state) {
    Signature signature;
    if (Model::ending(state) != Ending::running) return signature;
    constexpr double unit = 1e6;
    for (std::size_t action = 0; action < actions(); ++action) {
      double reward = 0;
      double leads_to = 0;
      comparing_.for_each_path([&](Enumerator& path) {
        count_path(path);
        State next = state;
        const Step step = Model::step(next, static_cast<int>(action), path);
        reward += path.probability() * step.reward;
        if (Model::ending(next) != Ending::running) return;
        std::uint64_t hash = hash_of(key_of(next));
        if (observations_matter_) hash = mixed(hash, static_cast<std::uint64_t>(step.observation));
        leads_to += path.probability() * (1 + static_cast<double>(hash >> 40));
      });
      signature.push_back(std::round(unit * reward));
      signature.push_back(std::round(leads_to));
    }
    return signature;
  }

  void try_variables(const State& state) {
    const std::size_t before = work_;
    const Signature signature = signature_of(state);
    for (Variable& variable : variables_) {
      for (std::size_t i = 0; i < variable.examples.size() && !variable.matters; ++i) {
        State exchanged = state;
        copy_place(variable.place, variable.examples[i], exchanged);
        variable.matters = makes_difference(exchanged, signature);
      }
    }
    trying_work_ += work_ - before;
  }

  // By the variables that have been found to matter; returns whether there are new ones.
  bool tell_apart() {
    const auto before = mask_;
    for (const Variable& variable : variables_) set_ignored(variable.place, !variable.matters);
    find_words();
    return mask_ != before;
  }

  // An exchange may give a state that cannot be reached, of which model code need not make sense.
  bool makes_difference(const State& exchanged, const Signature& signature) {
    try {
      return signature_of(exchanged) != signature;
    } catch (const ModelFault&) {
      return true;
    }
  }

  static std::size_t actions() { return static_cast<std::size_t>(Model::action_count()); }

  bool observations_matter_ = false;
  std::vector<Variable> variables_;
  std::array<std::uint64_t, std::tuple_size_v<Key>> mask_{};  // of a whole state
  std::array<std::size_t, std::tuple_size_v<Key>> word_{};
  std::size_t words_ = 0;
  std::size_t work_ = 0;
  std::size_t trying_work_ = 0;
  Enumerator comparing_;
  std::vector<State> states_;
  std::vector<Key> keys_;
  std::vector<std::uint32_t> numbers_;
  std::vector<float> rewards_;
  std::vector<std::size_t> branch_ends_;
  std::vector<Branch> branches_;
};

}  // namespace aos
