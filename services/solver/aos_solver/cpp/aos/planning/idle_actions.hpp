// Actions after which everything is as before, so that the next decision is the same one again.
#pragma once

#include "aos/belief/belief.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/planning/coming_to_an_end.hpp"
#include "aos/planning/listed/state_numbers.hpp"

namespace aos {

inline constexpr std::size_t most_states_compared = 20'000;

// What an action earns that pays nothing, changes no running state of a belief, and is answered alike in all of them, without a draw. Nothing
// if it is no such action.
template <class Model>
std::optional<double> earned_idle(const Belief<Model>& belief, int action) {
  if (belief.particles().size() > most_states_compared) return {};
  const ForgottenTexts forgotten;
  const StateNumbers<Model> numbers;
  Enumerator draws;
  typename Model::State next{};
  Step step;
  std::optional<Observation> told;
  bool changes_nothing = true;
  double earned = 0;
  const bool is_certain = comes_to_an_end([&] {
    for (const auto& [state, weight] : belief.particles()) {
      if (Model::ending(state) != Ending::running) continue;
      const auto run = [&](Enumerator& path) {
        next = state;
        step = Model::step(next, action, path);
      };
      draws.for_each_path(run, [](Enumerator&) {}, /*max_paths=*/1);
      if (!told) told = step.observation;
      changes_nothing = step.reward <= 0 && step.observation == *told && Model::ending(next) == Ending::running && numbers.are_same(state, next);
      if (!changes_nothing) return;
      earned += weight * step.reward;
    }
  });
  return is_certain && changes_nothing && told ? std::optional{earned} : std::nullopt;
}

template <class Model>
bool is_idle(const Belief<Model>& belief, int action) {
  return earned_idle(belief, action).has_value();
}

}
