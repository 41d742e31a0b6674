// The commands of a study: exact values and their terms at one supposed belief after the other.
#pragma once

#include "aos/belief/gathering.hpp"
#include "aos/child/belief_commands.hpp"
#include "aos/child/command.hpp"
#include "aos/child/reward_terms.hpp"
#include "aos/child/wording.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/listed/state_space.hpp"
#include "aos/text/json.hpp"
#include "numbers/exact.hpp"

namespace aos {

template <class Model>
class StudyCommands {
 public:
  explicit StudyCommands(const BeliefCommands<Model>& beliefs) : beliefs_(beliefs) {}

  // Writes the exact value of each action. What is listed is kept for the next belief.
  void exact_values(JsonWriter& json, const Command& command) {
    const int horizon = horizon_of<Model>(command);
    const Belief<Model>& belief = beliefs_.belief_for(command);
    auto evaluation = evaluation_for(command, belief, horizon);
    const auto values = evaluation.action_values(space_->exact_weights_of(belief), horizon);
    json.begin_object().key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      json.begin_object().member("action", Model::action_name(action));
      json.member("q", values[action].value).end_object();
    }
    json.end_array().member("error", evaluation.error(horizon) + space_->slack(belief, horizon));
    json.member("beliefs", evaluation.beliefs()).member("states", space_->size()).end_object();
  }

  // Writes the terms of an action's value over the whole horizon, or of its first step alone (`is_first`).
  void reward_terms(JsonWriter& json, const Command& command) {
    const int action = action_of<Model>(command);
    const Belief<Model>& belief = beliefs_.belief_for(command);
    if (command.flag("is_first")) return first_terms(json, belief, action);
    RewardTerms<Model> terms;
    const int horizon = horizon_of<Model>(command);
    auto evaluation = evaluation_for(command, belief, horizon);
    evaluation.action_values(space_->exact_weights_of(belief), horizon);
    const auto times = evaluation.occupancy(space_->weights_of(belief), action, horizon);
    for (const auto& [where, weight] : times) terms.add((*space_)[where.first], where.second, weight);
    terms.write(json);
  }

 private:
  static constexpr int most_paths = 50'000;
  static constexpr std::size_t drawn_steps = 10'000;

  // Writes the expected rewards of a step; where these cannot be enumerated, the means of steps that are drawn, with the same
  // luck for each action.
  static void first_terms(JsonWriter& json, const Belief<Model>& belief, int action) {
    try {
      RewardTerms<Model> terms;
      int left = most_paths;
      for (const auto& [state, weight] : belief.particles()) {
        if (Model::ending(state) != Ending::running) continue;
        if (left <= 0) throw NotEnumerable{"the belief has too many states"};
        left -= terms.add(state, action, weight, std::min(left, path_budget));
      }
      return terms.write(json);
    } catch (const NotEnumerable&) {
      blame::at(0);
    }
    const ForgottenTexts forgotten;
    RewardTerms<Model> drawn;
    Sampler random{1};
    draw_evenly<Model>(belief.particles(), drawn_steps, random, [&](const typename Model::State& state) {
      if (Model::ending(state) == Ending::running) drawn.add_drawn(state, action, 1.0 / drawn_steps, random);
    });
    drawn.write(json);
  }

  ExactEvaluation evaluation_for(const Command& command, const Belief<Model>& belief, int horizon) {
    const std::chrono::duration<double> limit{command.number<double>("seconds")};
    const auto start = std::chrono::steady_clock::now();
    reach(belief, horizon);
    observable_.prepare(space_->rows(), space_->numbering(), horizon);
    return {space_->rows(), observable_,
            {.beliefs = command.number<std::uint64_t>("beliefs"),
             .is_over = [=] { return std::chrono::steady_clock::now() - start > limit; }}};
  }

  // Lists what a belief reaches. Where that and what is kept do not fit together, it is listed alone.
  void reach(const Belief<Model>& belief, int horizon) {
    try {
      if (space_) return space_->reach_within(belief, horizon);
    } catch (const NotEnumerable&) {
      blame::at(0);
    }
    space_ = std::make_unique<StateSpace<Model>>();
    observable_ = {};
    space_->reach_within(belief, horizon);
  }

  const BeliefCommands<Model>& beliefs_;
  std::unique_ptr<StateSpace<Model>> space_;
  ObservableValues observable_;
};

}
