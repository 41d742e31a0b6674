// A model for the engine's templates whose steps are looked up in the tables of the problem at hand, so that thousands
// of models run through the engine's own headers without being compiled.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/belief/belief.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/draws/random.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/rollout.hpp"
#include "aos/model/step.hpp"
#include "aos/model/values.hpp"
#include "problem.hpp"

namespace exam {

struct TableModel {
  static constexpr std::size_t max_variables = 15;

  struct State {
    std::int16_t variables[max_variables]{};
    aos::Ending ending = aos::Ending::running;
    std::uint8_t unused = 0;

    friend bool operator==(const State& left, const State& right) {
      return std::memcmp(&left, &right, sizeof left) == 0;
    }
  };
  static_assert(sizeof(State) == 32 && std::is_trivially_copyable_v<State>);

  static constexpr const char* project = "exam";
  static constexpr bool has_rollout_policy = false;
  static constexpr bool has_state_heuristic = false;
  static constexpr int skill_count = 1;
  inline static int horizon = 0;
  inline static double discount = 0;
  inline static bool has_goal_conditions = false;
  inline static std::uint64_t noisy_steps = 0;  // that were drawn
  inline static std::uint64_t noisy_steps_with_texts = 0;  // whose texts are remembered

  // Makes a problem the one at hand; it must stay.
  static void take(const Problem& problem) {
    problem_ = &problem;
    horizon = problem.horizon;
    discount = problem.discount;
    has_goal_conditions = !problem.conditions.empty();
    weights_.clear();
    weights_.resize(problem.rows.size() + problem.sensings.size());
    for (std::size_t row = 0; row < problem.rows.size(); ++row) {
      for (const Outcome& outcome : problem.rows[row]) weights_[row].push_back(outcome.probability);
    }
    for (std::size_t sensing = 0; sensing < problem.sensings.size(); ++sensing) {
      for (const Reading& reading : problem.sensings[sensing]) {
        weights_[problem.rows.size() + sensing].push_back(reading.probability);
        while (reading.observation >= response_count(0)) responses_.push_back("o" + std::to_string(responses_.size()));
      }
    }
    irrelevant_.clear();
    for (const std::size_t variable : problem.irrelevant) {
      irrelevant_.push_back({offsetof(State, variables) + 2 * variable, sizeof(std::int16_t)});
    }
    start_weights_.clear();
    for (const Start& start : problem.starts) start_weights_.push_back(start.probability);
    std::size_t slots = 64;
    while (slots < 4 * problem.states()) slots *= 2;
    slots_.assign(slots, none);
    states_.clear();
    for (std::uint32_t number = 0; number < problem.states(); ++number) {
      states_.push_back(listed_state(problem, number));
      std::size_t& slot = slots_[slot_of(states_.back())];
      if (slot != none) throw std::runtime_error("a problem lists a state twice");
      slot = number;
    }
  }

  // Of a state of the problem, or of one that agrees with it in what matters: a list of states keeps irrelevant variables of
  // one state only.
  static std::uint32_t number_of(const State& state) {
    const std::size_t number = slots_[slot_of(state)];
    if (number != none) return static_cast<std::uint32_t>(number);
    for (const State& listed : states_) {
      State alike = state;
      for (const std::size_t variable : problem_->irrelevant) alike.variables[variable] = listed.variables[variable];
      if (alike == listed) return static_cast<std::uint32_t>(&listed - states_.data());
    }
    throw aos::ModelFault{"AOS215", "a state that the exam's model does not have"};
  }

  static void prepare() {}
  static int action_count() { return static_cast<int>(problem_->actions); }
  static int monitor_count() { return 0; }
  static bool reports_numbers() { return false; }
  static int skill_of(int) { return 0; }
  static int number_count(int) { return 0; }
  static bool has_alike_groundings(int) { return false; }
  static bool has_certain_rewards(int) { return false; }
  static int response_count(int) { return static_cast<int>(responses_.size()); }
  static const char* response_name(int, int response) { return responses_[response].c_str(); }
  static aos::Ending ending(const State& state) { return state.ending; }
  static std::uint64_t hash(const State& state) {
    std::uint64_t words[sizeof state / 8];
    std::memcpy(words, &state, sizeof words);
    std::uint64_t hash = 0;
    for (const std::uint64_t word : words) hash = aos::mixed(hash, word);
    return hash;
  }
  static std::span<const aos::ByteRange> irrelevant() { return irrelevant_; }
  static std::size_t state_bytes() { return sizeof(State); }
  static const std::byte* bytes_of(const State& state) { return reinterpret_cast<const std::byte*>(&state); }
  static std::byte* bytes_of(State& state) { return reinterpret_cast<std::byte*>(&state); }
  static std::size_t bytes_elsewhere() { return 0; }
  static std::string state_text(const State& state) { return std::to_string(number_of(state)); }

  static void visit_values(const State& state, aos::ValueVisitor& visitor) {
    visitor.begin_compound();
    for (std::size_t i = 0; i < problem_->variables; ++i) {
      const std::string name = "v" + std::to_string(i);
      visitor.member(name.c_str());
      visitor.leaf(aos::leaf_of(state.variables[i]));
    }
    visitor.member("ending");
    visitor.leaf(aos::leaf_of(state.ending));
    visitor.end();
  }

  template <class Random>
  static void initial(State& state, Random& random) {
    state = states_[problem_->starts[chosen(start_weights_, random)].state];
  }
  template <class Random>
  static aos::Step step(State& state, int action, Random& random) {
    if (problem_->noise != Noise::none) draw_noise(random);
    if (state.ending != aos::Ending::running) return {};
    const std::size_t number = number_of(state) * problem_->actions + static_cast<std::size_t>(action);
    const Outcome& outcome = problem_->rows[number][chosen(weights_[number], random)];
    const auto& readings = problem_->sensings[outcome.sensing];
    state = states_[outcome.next];
    return {outcome.reward, readings[chosen(weights_[problem_->rows.size() + outcome.sensing], random)].observation};
  }
  static bool meets_precondition(const State&, int, auto&) { return true; }
  static int conditions_met(const State& state) { return has_goal_conditions ? problem_->conditions[number_of(state)] : 0; }

  static double rollout(const State& state, int& left, aos::Sampler& random) {
    return aos::rollout<TableModel>(state, left, random);
  }
  static void rollout_odds(const State& state, double* odds, aos::Sampler& random) {
    aos::rollout_odds<TableModel>(state, odds, action_count(), random);
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  static State listed_state(const Problem& problem, std::uint32_t number) {
    State state{};
    if (problem.variables > max_variables) throw std::runtime_error("a problem has too many variables");
    for (std::size_t i = 0; i < problem.variables; ++i) {
      state.variables[i] = static_cast<std::int16_t>(problem.values[number * problem.variables + i]);
    }
    state.ending = static_cast<aos::Ending>(problem.endings[number]);
    return state;
  }

  static std::size_t slot_of(const State& state) {
    std::size_t slot = hash(state) & (slots_.size() - 1);
    while (slots_[slot] != none && !(states_[slots_[slot]] == state)) slot = (slot + 1) & (slots_.size() - 1);
    return slot;
  }

  template <class Random>
  static void draw_noise(Random& random) {
    if constexpr (std::derived_from<Random, aos::Sampler>) {
      ++noisy_steps;
      noisy_steps_with_texts += aos::remembers_texts;
    } else if (problem_->noise == Noise::refused) {
      throw aos::NotEnumerable{"there is a continuous draw"};
    }
    random.uniform();
  }

  template <class Random>
  static std::size_t chosen(const aos::List<double>& weights, Random& random) {
    if (weights.size() == 1) return 0;
    return static_cast<std::size_t>(random.choose(weights.data(), static_cast<int>(weights.size()), 1.0));
  }

  inline static const Problem* problem_ = nullptr;
  inline static aos::List<aos::ByteRange> irrelevant_;
  inline static aos::List<std::string> responses_;
  inline static aos::List<State> states_;
  inline static aos::List<std::size_t> slots_;
  inline static aos::List<aos::List<double>> weights_;  // of the rows, then of the sensings
  inline static aos::List<double> start_weights_;
};

// The belief after a response, and the probability of that; an empty belief where it is impossible.
inline std::pair<aos::Belief<TableModel>, double> posterior_of(const aos::Belief<TableModel>& belief, int action,
                                                               aos::Observation seen, aos::Sampler& random) {
  auto [posterior, log_probability] = belief.posterior(action, seen, aos::ignored_numbers, random);
  const double probability = posterior.particles().empty() ? 0 : std::exp(log_probability);
  return {std::move(posterior), probability};
}

}
