// The commands of an engine child. Every answer is a JSON object.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "aos/base/json.hpp"
#include "aos/base/progress.hpp"
#include "aos/child/belief_commands.hpp"
#include "aos/child/command.hpp"
#include "aos/child/planning_commands.hpp"
#include "aos/child/rates.hpp"
#include "aos/child/risk_commands.hpp"
#include "aos/child/watchdog.hpp"
#include "aos/child/world_commands.hpp"
#include "aos/planning/planner.hpp"

namespace aos {

template <class Model>
class Commands {
 public:
  Commands(std::uint64_t seed, ImpossiblePolicy policy, const char* kept_beliefs)
      : beliefs_(seed, policy, kept_beliefs, search_), planning_(beliefs_, search_) {}

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

  void answer(const Command& command, JsonWriter& json) {
    const std::string_view name = command.name();
    if (command.optional_text("max_seconds")) watchdog::allow(command.number<double>("max_seconds"));
    if (name == "describe") return describe(json);
    if (name == "tell_progress") return tell_progress(json, command);
    if (name == "summary") return beliefs_.summary(json);
    if (name == "reset_belief") return beliefs_.reset(json);
    if (name == "draw_belief") return beliefs_.draw(json);
    if (name == "predict") return beliefs_.predict(json, command);
    if (name == "update") return beliefs_.update(json, command);
    if (name == "update_without_observation") return beliefs_.update_without_observation(json, command);
    if (name == "export_belief") return beliefs_.export_belief(json, command);
    if (name == "describe_beliefs") return beliefs_.describe_beliefs(json);
    if (name == "import_belief") return beliefs_.import_belief(json, command);
    if (name == "restore_belief") return beliefs_.restore(json, command);
    if (name == "risks") return write_risks(json, command, beliefs_.belief());
    if (name == "plan") return planning_.plan(json, command);
    if (name == "ponder") return planning_.ponder(json, command);
    if (name == "count_processor_time") return planning_.count_processor_time(json, command);
    if (name == "exact") return planning_.exact(json, command);
    if (name == "reach") return planning_.reach(json, command);
    if (name == "may_reach_goal") return planning_.may_reach_goal(json, command);
    if (name == "list") return planning_.list(json, command);
    if (name == "write_listing") return planning_.write_listing(json, command);
    if (name == "reset_world") return worlds_.reset(json, command);
    if (name == "step_world") return worlds_.step(json, command);
    if (name == "show_world") return worlds_.show(json);
    if (name == "reset_worlds") return worlds_.reset_many(json, command);
    if (name == "step_worlds") return worlds_.step_many(json, command);
    if (name == "rate") return write_code_rate<Model>(json, command);
    if (name == "rate_by_table") return write_table_rate<Model>(json, command);
    throw BadCommand{"unknown command: " + std::string{name}};
  }

  // From now on, answers that take long are preceded by lines of progress, one in so many milliseconds.
  static void tell_progress(JsonWriter& json, const Command& command) {
    progress::between = std::chrono::milliseconds{command.number<int>("between_ms")};
    json.begin_object().end_object();
  }

  template <class IsOver>
  void go_on_pondering(IsOver&& is_over) {
    planning_.go_on_pondering(is_over);
  }

 private:
  Planner<Model> search_;
  BeliefCommands<Model> beliefs_;
  PlanningCommands<Model> planning_;
  WorldCommands<Model> worlds_;
};

}  // namespace aos
