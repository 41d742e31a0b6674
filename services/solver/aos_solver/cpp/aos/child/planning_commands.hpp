// The commands that let an engine child decide and look ahead: searches, reachable states, the risks of constraints.
#pragma once

#include "aos/base/clock.hpp"
#include "aos/belief/risks.hpp"
#include "aos/child/belief_commands.hpp"
#include "aos/child/command.hpp"
#include "aos/child/listing.hpp"
#include "aos/child/reachability.hpp"
#include "aos/child/wording.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/budget.hpp"
#include "aos/planning/idle_actions.hpp"
#include "aos/planning/planners.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class PlanningCommands {
 public:
  PlanningCommands(BeliefCommands<Model>& beliefs, Planners<Model>& search) : beliefs_(beliefs), search_(search) {}

  // The command's items are the numbers of the actions that cannot be carried out now. The skills that it names as
  // `without`, and the actions whose numbers are `without_actions`, are not there for the whole search.
  void plan(JsonWriter& json, const Command& command) {
    const auto left_out = left_out_by(command);
    const List<int> left = actions_left(left_out);
    if (left.empty()) throw BadCommand{"no action is left"};
    if (left_out.empty()) return plan_with(search_, json, command, left);
    const typename Model::Without without{left_out};
    if (!shorter_search_ || left != left_) shorter_search_ = std::make_unique<Planners<Model>>();
    left_ = left;
    shorter_search_->forget();
    plan_with(*shorter_search_, json, command, left);
    planned_horizon_ = 0;  // what follows is not pondered
  }

  // Notes an action that is carried out now. `go_on_pondering` then plans what may come after it.
  void ponder(JsonWriter& json, const Command& command) {
    pondered_ = {action_of<Model>(command), budget_of(command), command.number<std::uint64_t>("seed")};
    json.begin_object().end_object();
  }

  // Ponders until the budget is used up or `is_over()`. A fault is dropped: the next search meets it again.
  void go_on_pondering(auto&& is_over) {
    if (!pondered_ || planned_horizon_ == 0) return;
    const Pondered pondered = *std::exchange(pondered_, std::nullopt);
    Sampler random{pondered.seed};
    try {
      const bool is_cautious = planned_cautiously_ && beliefs_.cautious() != nullptr;
      const Belief<Model>& planned = is_cautious ? *beliefs_.cautious() : belief();
      search_.ponder(pondered.action, planned, pondered.budget, planned_horizon_, random, is_over);
      pondered_simulations_ = search_.simulations_by_thread();
    } catch (...) {
      search_.forget();
      blame::at(0);
    }
  }

  // From now on, budgets in seconds count processor time, or real time again.
  void count_processor_time(JsonWriter& json, const Command& command) {
    PlanningClock::counts_processor_time = command.flag("counts");
    json.begin_object().end_object();
  }

  void reach(JsonWriter& json, const Command& command) const {
    const Reachability<Model> reached{belief(), command.number<double>("seconds")};
    json.begin_object().member("has_goal", reached.has_goal()).key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      json.begin_object().member("name", Model::action_name(action));
      json.member("skill", Model::skill_name(Model::skill_of(action))).member("is_met", reached.is_met(action)).end_object();
    }
    json.end_array().member("states", reached.states()).member("depth", reached.depth());
    json.member("limit", reached.limit()).member("is_whole", reached.is_whole()).end_object();
  }

  void may_reach_goal(JsonWriter& json, const Command& command) const {
    const auto left_out = left_out_by(command);
    std::optional<typename Model::Without> without;
    if (!left_out.empty()) without.emplace(left_out);
    Sampler random{command.number<std::uint64_t>("seed")};
    const auto seconds = command.number<double>("seconds");
    const bool can_reach = can_reach_goal(beliefs_.belief_for(command), seconds, horizon_of<Model>(command), random);
    json.begin_object().member("is_reachable", can_reach).end_object();
  }

  // Writes, for each action, the probability of violating each constraint in the next step. `is_sampled` tells that some of the
  // probabilities are estimates. The seed serves these estimates alone.
  void risks(JsonWriter& json, const Command& command) const {
    Sampler random{command.number<std::uint64_t>("seed")};
    const std::size_t max_paths = max_enumerated_paths / std::max(Model::action_count(), 1);
    bool is_sampled = false;
    json.begin_object().key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      const Risks risks = risks_of(belief(), action, max_paths, random);
      is_sampled = is_sampled || risks.is_sampled;
      json.begin_array();
      for (const double probability : risks.probabilities) json.value(std::clamp(probability, 0.0, 1.0));
      json.end_array();
    }
    json.end_array().member("is_sampled", is_sampled).end_object();
  }

  // Lists the model from the current belief on. A call without a limit of states continues the listing before it.
  void list(JsonWriter& json, const Command& command) {
    const auto max_states = command.number<std::size_t>("max_states");
    if (max_states > 0) listing_.emplace(belief(), max_states);
    if (!listing_) throw BadCommand{"nothing is listed"};
    listing_->go_on(json);
  }
  void write_listing(JsonWriter& json, const Command& command) {
    if (!listing_) throw BadCommand{"nothing is listed"};
    listing_->write(json, command.number<int>("descriptor"));
    listing_.reset();
  }

 private:
  struct Pondered {
    int action;
    Budget budget;
    std::uint64_t seed;
  };

  const Belief<Model>& belief() const { return beliefs_.belief(); }

  static List<int> actions_left(const std::vector<bool>& left_out) {
    List<int> actions(Model::action_count());
    std::iota(actions.begin(), actions.end(), 0);
    erase_if(actions, [&](int action) { return !left_out.empty() && left_out[action]; });
    return actions;
  }
  // For each action whether it is left out; empty if none is.
  static std::vector<bool> left_out_by(const Command& command) {
    const std::string_view skills = command.optional_text("without").value_or(std::string_view{});
    const std::string_view numbers = command.optional_text("without_actions").value_or(std::string_view{});
    if (skills.empty() && numbers.empty()) return {};
    std::vector<bool> left_out(Model::action_count(), false);
    for (const auto skill : detail::parts_of(skills, ',')) {
      for (int action = 0; action < Model::action_count(); ++action) {
        if (skill == Model::skill_name(Model::skill_of(action))) left_out[action] = true;
      }
    }
    if (numbers.empty()) return left_out;
    for (const auto number : detail::parts_of(numbers, ',')) left_out.at(detail::number_in<std::size_t>(number)) = true;
    return left_out;
  }

  // Plans with the model's actions as they are now; `numbers` are those that they have in the documents.
  void plan_with(Planners<Model>& search, JsonWriter& json, const Command& command, const List<int>& numbers) {
    const auto start = std::chrono::steady_clock::now();
    const auto processor_start = processor_time();
    const Belief<Model>& belief = beliefs_.belief_for(command);
    const Budget budget = budget_of(command);
    const int horizon = horizon_of<Model>(command);
    const auto planner = planner_kind(command.text("planner"));
    if (!planner) throw BadCommand{"there is no planner " + std::string{command.text("planner")}};
    const bool is_cautious = &belief != &beliefs_.belief();
    if (horizon != planned_horizon_ || is_cautious != planned_cautiously_) search.forget();
    planned_horizon_ = horizon;
    planned_cautiously_ = is_cautious;
    const BarredActions barred = barred_by(command, numbers);
    Sampler random{command.number<std::uint64_t>("seed")};
    const std::uint64_t known = search.known_simulations();
    const std::uint64_t simulations = search.search(*planner, belief, budget, horizon, random, barred);
    const auto estimates = search.estimates(belief);
    const int best = search.choice(belief, estimates, barred);
    const auto values = search.values(belief, estimates, best);
    json.begin_object().member("index", numbers[best]).member("place", best);
    json.member("simulations", simulations).member("horizon", horizon).member("known_simulations", known);
    const std::string_view name = search.name();
    const bool idles = is_idle(belief, best);
    json.member("planner", name).member("why", search.why() + (idles ? idle_text : "")).member("is_idle", idles);
    json.member("threads", name == "pomcp" ? budget.threads : 1);  // only POMCP has several threads
    json.key("by_thread").values(search.simulations_by_thread()).key("pondered").values(std::exchange(pondered_simulations_, {}));
    json.key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      const auto& value = values[action];
      json.begin_object().member("action", Model::action_name(action)).member("q", value.q).member("n", value.n);
      json.member("stderr", value.standard_error);
      // An action that cannot be taken returns nothing now, however much it would.
      const bool is_barred = barred.contains(action);
      json.member("at_least", value.at_least);
      json.member("at_most", is_barred ? std::numeric_limits<double>::infinity() : value.at_most).end_object();
    }
    json.end_array().key("predicted");
    BeliefCommands<Model>::write_predicted(json, best, belief, command.number<std::uint64_t>("seed"));
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    const std::chrono::duration<double> processor{processor_time() - processor_start};
    json.member("seconds", spent.count()).member("cpu_seconds", processor.count());
    json.member("preparation_s", search.preparing().count()).member("search_s", search.searching().count()).end_object();
  }

  static constexpr const char* idle_text = "; nothing is known that is worth more than this action, which changes nothing and tells nothing";

  // The actions that the command bars, by their numbers among `numbers`.
  static BarredActions barred_by(const Command& command, const List<int>& numbers) {
    BarredActions barred;
    for (const auto item : command.items()) {
      const auto place = std::ranges::find(numbers, detail::number_in<int>(item));
      if (place == numbers.end()) continue;
      barred.insert(static_cast<std::size_t>(place - numbers.begin()));
    }
    return barred;
  }

  static Budget budget_of(const Command& command) {
    const int threads = command.number<int>("threads");
    return {command.number<std::uint64_t>("simulations"), command.number<double>("seconds"),
            std::clamp(threads, 1, max_search_threads)};
  }

  BeliefCommands<Model>& beliefs_;
  Planners<Model>& search_;
  int planned_horizon_ = 0;
  bool planned_cautiously_ = false;
  List<int> left_;
  std::unique_ptr<Planners<Model>> shorter_search_;  // with the actions that are `left_`
  std::optional<Pondered> pondered_;
  List<std::uint64_t> pondered_simulations_;  // since the last plan
  std::optional<Listing<Model>> listing_;
};

}
