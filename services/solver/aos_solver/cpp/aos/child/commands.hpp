// What an engine child can be asked, one method for each command; answers are JSON objects.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "aos/base/base64.hpp"
#include "aos/base/clock.hpp"
#include "aos/base/fault.hpp"
#include "aos/base/json.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/kept_beliefs.hpp"
#include "aos/child/bad_command.hpp"
#include "aos/child/left_out.hpp"
#include "aos/child/listing.hpp"
#include "aos/child/rates.hpp"
#include "aos/child/reachability.hpp"
#include "aos/child/saved_beliefs.hpp"
#include "aos/child/worlds.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/correction.hpp"
#include "aos/planning/exact.hpp"
#include "aos/planning/planner.hpp"

namespace aos {

template <class Model>
class Engine {
 public:
  using State = typename Model::State;
  using Corrected = CorrectedModel<Model>;

  // `kept_beliefs` is the path of the file for KeptBeliefs.
  Engine(std::uint64_t seed, ImpossiblePolicy policy, const char* kept_beliefs)
      : random_(seed), policy_(policy), belief_(Belief<Model>::initial(random_)), kept_(kept_beliefs), hidden_() {}

  void describe(JsonWriter& json) const {
    json.begin_object().member("project", Model::project).member("horizon", Model::horizon);
    json.member("discount", Model::discount).key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      const int skill = Model::skill_of(action);
      json.begin_object().member("name", Model::action_name(action)).member("skill", Model::skill_name(skill));
      Model::write_parameters(action, json.key("parameters"));
      json.end_object();
    }
    json.end_array().key("responses").begin_object();
    for (int skill = 0; skill < Model::skill_count; ++skill) {
      json.key(Model::skill_name(skill)).begin_array();
      for (int response = 0; response < Model::response_count(skill); ++response) {
        json.value(Model::response_name(skill, response));
      }
      json.end_array();
    }
    json.end_object().end_object();
  }

  void reset_belief(JsonWriter& json) {
    become(json, Belief<Model>::initial(random_), [&] { search_.start_over(); });
  }

  // The initial belief as particles, also where it could be enumerated: to try the one against the other.
  void draw_belief(JsonWriter& json) { become(json, Belief<Model>::drawn(random_)); }

  void summary(JsonWriter& json) const { belief_.write_summary(json); }

  // `barred_actions` are the numbers of actions that cannot be carried out now.
  void plan(JsonWriter& json, Budget budget, std::uint64_t seed, int horizon, PlannerKind planner,
            const std::vector<int>& barred_actions) {
    const auto start = std::chrono::steady_clock::now();
    const auto processor_start = processor_time();
    if (horizon <= 0) horizon = Model::horizon;
    if (horizon != planned_horizon_) search_.forget();
    planned_horizon_ = horizon;
    Sampler random{seed};
    const std::uint64_t known = search_.known_simulations();
    for (const int action : barred_actions) checked(action);
    const BarredActions barred{barred_actions};
    const std::uint64_t simulations = search_.search(planner, belief_, budget, horizon, random, barred);
    const auto estimates = search_.estimates(belief_);
    const int best = search_.choice(estimates, barred);
    json.begin_object().member("index", best).member("simulations", simulations).member("horizon", horizon);
    json.member("known_simulations", known);
    const std::string_view name = search_.name();
    json.member("planner", name).member("why", search_.why());
    json.member("threads", name == "pomcp" ? budget.threads : 1);  // Only POMCP shares its work out.
    json.key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      const auto& estimate = estimates[static_cast<std::size_t>(action)];
      json.begin_object().member("action", Model::action_name(action)).member("q", estimate.q);
      json.member("n", estimate.n).member("stderr", estimate.standard_error).end_object();
    }
    json.end_array().key("predicted");
    write_predicted(json, best);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    json.member("seconds", spent.count()).member("cpu_seconds", seconds_since(processor_start)).end_object();
  }

  // Begins to think about what may come after an action that is carried out now; `go_on_thinking` does it.
  void think(JsonWriter& json, Budget budget, std::uint64_t seed, int action) {
    thought_ = {.action = checked(action), .budget = budget, .seed = seed};
    json.begin_object().end_object();
  }

  // Until the budget is used up or `is_over()`. A fault is left to the next search that meets it.
  template <class IsOver>
  void go_on_thinking(IsOver&& is_over) {
    if (!thought_ || planned_horizon_ == 0) return;
    const Thought thought = *std::exchange(thought_, std::nullopt);
    Sampler random{thought.seed};
    try {
      search_.think_about(thought.action, belief_, thought.budget, planned_horizon_, random, is_over);
    } catch (...) {
      search_.forget();
      blame::at(0);
    }
  }

  // Budgets in seconds are of processor time from now on, or of real time again.
  void count_processor_time(JsonWriter& json, bool counts) {
    PlanningClock::counts_processor_time = counts;
    json.begin_object().end_object();
  }

  void exact(JsonWriter& json, int horizon, std::uint64_t belief_budget, double seconds) const {
    if (horizon <= 0) horizon = Model::horizon;
    const auto start = std::chrono::steady_clock::now();
    const auto is_over = [=] { return std::chrono::steady_clock::now() - start > std::chrono::duration<double>{seconds}; };
    StateSpace<Model> space;
    space.reach_within(belief_, horizon);
    ExactEvaluation<Model> evaluation{space, {.beliefs = belief_budget, .is_over = is_over}};
    const auto values = evaluation.action_values(belief_, horizon);
    json.begin_object().key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      json.begin_object().member("action", Model::action_name(action));
      json.member("q", values[static_cast<std::size_t>(action)].value).end_object();
    }
    json.end_array().member("beliefs", evaluation.beliefs()).member("states", space.size()).end_object();
  }

  void reach(JsonWriter& json, double seconds) const {
    const Reachability<Model> reached{belief_, seconds};
    json.begin_object().member("has_goal", reached.has_goal()).key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      json.begin_object().member("name", Model::action_name(action));
      json.member("skill", Model::skill_name(Model::skill_of(action))).member("is_met", reached.is_met(action)).end_object();
    }
    json.end_array().member("states", reached.states()).member("depth", reached.depth());
    json.member("limit", reached.limit()).end_object();
  }

  // `numbers` were observed beside the response. Where no step of the model reports just these with it, the response
  // counts alone. `locals`, where given, are the values of the mapping's local variables, and the belief is corrected with
  // them; a fault in that is told with the answer, which is then that of the observation alone.
  void update(JsonWriter& json, int action, std::string_view response, const ObservedNumbers& numbers,
              std::optional<std::string_view> locals) {
    const Observation observation = observation_of(checked(action), response);
    Uncorrected uncorrected;
    const auto by = [&](auto&& sink) {
      return locals ? corrected_posterior(action, observation, sink, *locals, uncorrected)
                    : belief_.posterior(action, observation, sink, random_);
    };
    auto [posterior, log_probability] = by(WeighedNumbers{numbers});
    bool has_other_numbers = false;
    if (posterior.particles().empty() && Model::number_count(Model::skill_of(action)) > 0) {
      WeighedNumbers reported{numbers, /*by_value=*/false};
      has_other_numbers = belief_.posterior(action, observation, reported, random_).first.particles().empty();
      if (has_other_numbers) std::tie(posterior, log_probability) = by(ignored_numbers);
    }
    const bool is_impossible = posterior.particles().empty();
    json.begin_object().member("log_probability", is_impossible ? 0 : log_probability);
    json.member("is_impossible", is_impossible).member("has_other_numbers", has_other_numbers && !is_impossible);
    if (!uncorrected.code.empty()) {
      json.key("uncorrected").begin_object().member("code", uncorrected.code).member("text", uncorrected.text);
      json.member("piece", uncorrected.piece).end_object();
    }
    json.key("summary");
    if (is_impossible) {
      become(json, after_impossible(action));
    } else {
      become(json, std::move(posterior), [&] { search_.move_to(action, observation); });
    }
    json.end_object();
  }

  // Nobody knows whether the action ran.
  void update_without_observation(JsonWriter& json, int action, double ran_probability) {
    json.begin_object().member("log_probability", 0.0).member("is_impossible", false);
    become(json.key("summary"), belief_.predicted(checked(action), random_, ran_probability));
    json.end_object();
  }

  // The model as numbers from the current belief on: without a limit of states a call goes on where the last one ended.
  void list(JsonWriter& json, std::size_t max_states) {
    if (max_states > 0) listing_.emplace(belief_, max_states);
    if (!listing_) throw BadCommand{"nothing is listed"};
    listing_->go_on(json);
  }
  void write_listing(JsonWriter& json, const std::string& model_path, const std::string& states_path) {
    if (!listing_) throw BadCommand{"nothing is listed"};
    listing_->write(json, model_path, states_path);
    listing_.reset();
  }

  // How likely each observation is after an action.
  void predict(JsonWriter& json, int action) {
    json.begin_object().key("predicted");
    write_predicted(json, checked(action));
    json.end_object();
  }

  // From the particle of this number on; states may have stand-ins for what does not matter.
  void export_belief(JsonWriter& json, std::size_t first, bool is_whole) const {
    const LeftOut<Model> left_out;
    save_belief(json, belief_, first, [&](const State& state) { return is_whole ? state : left_out.rest_of(state); });
  }

  void import_belief(JsonWriter& json, double error_bound, bool is_drawn, std::string_view history,
                     std::size_t constant_count, const std::vector<std::string_view>& fields) {
    auto belief = load_belief<Model>(error_bound, is_drawn, history, constant_count, fields);
    if (belief.particles().empty()) throw BadCommand{"an empty belief"};
    become(json, std::move(belief));
  }

  // After the change of this number, of an engine before this one.
  void restore_belief(JsonWriter& json, std::uint64_t change) {
    auto kept = kept_.restore(change);
    if (!kept) throw BadCommand{"that belief was not kept"};
    belief_ = *std::move(kept);
    search_.forget();
    json.begin_object().end_object();
  }

  // Worlds for somebody who learns.
  void reset_worlds(JsonWriter& json, const std::vector<std::uint64_t>& seeds) { worlds_.reset(json, seeds); }

  // The actions are 32-bit numbers in base64.
  void step_worlds(JsonWriter& json, std::string_view text) {
    const auto actions = from_base64<std::int32_t>(text);
    if (!actions || actions->size() != worlds_.count()) throw BadCommand{"not one action for each world"};
    for (const std::int32_t action : *actions) checked(std::max(action, 0));
    worlds_.step(json, *actions);
  }

  // A world of its own, stepped by the model, for missions without a robot.
  void reset_world(JsonWriter& json, std::uint64_t seed) {
    world_random_ = Sampler{seed};
    hidden_ = State{};
    Model::initial(hidden_, world_random_);
    json.begin_object().member("ending", ending_text(hidden_)).end_object();
  }

  void step_world(JsonWriter& json, int action) {
    RecordedNumbers recorded{world_random_};
    const ReportingTo reporting{world_random_, recorded};
    const Step step = Model::step(hidden_, checked(action), world_random_);
    json.begin_object().member("reward", step.reward);
    json.member("response", response_text(action, step.observation)).member("ending", ending_text(hidden_));
    write_numbers(json.key("numbers"), recorded.numbers());
    json.end_object();
  }

  // The hidden state as text for people.
  void show_world(JsonWriter& json) const {
    json.begin_object().member("state", Model::state_text(hidden_)).end_object();
  }

  // How fast planners step the model by the documents' code.
  void rate(JsonWriter& json, double seconds, std::uint64_t seed) const {
    write_rate(json, seconds, CodeSteps<Model>{seed});
  }

  // The same by the table of a small model; none where there is no table.
  void rate_by_table(JsonWriter& json, double seconds, std::uint64_t seed) const {
    TableSteps<Model> steps{seed};
    write_rate(json, steps.is_there() ? seconds : 0, steps);
  }

 private:
  struct Thought {
    int action;
    Budget budget;
    std::uint64_t seed;
  };

  // Why an observation did not correct the belief; no code where it did.
  struct Uncorrected {
    std::string code;
    std::string text;
    std::uint32_t piece = 0;
  };

  template <class Numbers>
  std::pair<Belief<Model>, double> corrected_posterior(int action, Observation observation, Numbers& numbers,
                                                       std::string_view locals, Uncorrected& uncorrected) {
    try {
      Model::read_locals(action, locals);
      Corrected::made = observation;
      const auto [posterior, log_probability] =
          belief_.template as<Corrected>().posterior(action, observation, numbers, random_);
      return {posterior.template as<Model>(), log_probability};
    } catch (const ModelFault& fault) {
      uncorrected = {fault.code, fault.text, blame::piece()};
    } catch (const std::exception& error) {
      uncorrected = {"AOS215", error.what(), blame::piece()};
    }
    return belief_.posterior(action, observation, numbers, random_);
  }

  // Takes over a belief and tells it. Nothing changes where it cannot be told.
  void become(JsonWriter& json, Belief<Model> belief) {
    become(json, std::move(belief), [&] { search_.forget(); });
  }
  template <class Follow>
  void become(JsonWriter& json, Belief<Model> belief, Follow&& follow) {
    belief.write_summary(json);
    belief_ = std::move(belief);
    kept_.keep(belief_);
    follow();
  }

  static double seconds_since(std::chrono::nanoseconds processor_start) {
    return std::chrono::duration<double>{processor_time() - processor_start}.count();
  }

  static int checked(int action) {
    if (action < 0 || action >= Model::action_count()) throw BadCommand{"there is no such action"};
    return action;
  }

  static const char* ending_text(const State& state) {
    switch (Model::ending(state)) {
      case Ending::running: return "";
      case Ending::goal: return "goal";
      case Ending::failure: return "failure";
      case Ending::over: return "over";
    }
    return "";
  }

  static std::string response_text(int action, Observation observation) {
    if (observation >= 0) return Model::response_name(Model::skill_of(action), static_cast<int>(observation));
    if (observation == default_observation) return default_observation_text;
    return std::string{observation_text(observation)};
  }

  static Observation observation_of(int action, std::string_view response) {
    const int skill = Model::skill_of(action);
    for (int number = 0; number < Model::response_count(skill); ++number) {
      if (response == Model::response_name(skill, number)) return number;
    }
    if (response == default_observation_text) return default_observation;
    return text_observation(response);
  }

  // Each number as its name's number, its index and its value.
  static void write_numbers(JsonWriter& json, const ObservedNumbers& numbers) {
    json.begin_array();
    for (const auto& [key, value] : numbers) {
      json.begin_array().value(name_of_number(key)).value(index_of_number(key)).value(value).end_array();
    }
    json.end_array();
  }

  void write_predicted(JsonWriter& json, int action) {
    json.begin_array();
    for (const auto& [observation, probability] : belief_.observations(action, random_)) {
      json.begin_object().member("response", response_text(action, observation));
      json.member("probability", probability).end_object();
    }
    json.end_array();
  }

  // hold: what the action does is believed, what was seen is not. widen: the same, but half of the belief goes back to
  // what it was before and to the initial belief, in equal shares. reset: the initial belief.
  Belief<Model> after_impossible(int action) {
    const Belief<Model> initial = Belief<Model>::initial(random_);
    if (policy_ == ImpossiblePolicy::reset) return initial;
    const Belief<Model> predicted = belief_.predicted(action, random_);
    if (policy_ == ImpossiblePolicy::hold) return predicted;
    return predicted.mixed_with(belief_.mixed_with(initial, 0.5), 0.5);
  }

  Sampler random_;
  ImpossiblePolicy policy_;
  Belief<Model> belief_;
  KeptBeliefs<Model> kept_;
  Planner<Model> search_;
  int planned_horizon_ = 0;
  std::optional<Thought> thought_;
  State hidden_;
  Sampler world_random_{0};
  Worlds<Model> worlds_;
  std::optional<Listing<Model>> listing_;
};

}  // namespace aos
