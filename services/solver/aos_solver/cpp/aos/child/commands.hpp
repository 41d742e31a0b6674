// The commands of an engine child. Every answer is a JSON object.
#pragma once

#include "aos/base/progress.hpp"
#include "aos/child/belief_commands.hpp"
#include "aos/child/command.hpp"
#include "aos/child/planning_commands.hpp"
#include "aos/child/rates.hpp"
#include "aos/child/study_commands.hpp"
#include "aos/child/watchdog.hpp"
#include "aos/child/world_commands.hpp"
#include "aos/model/values.hpp"
#include "aos/planning/planners.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class Commands {
 public:
  Commands(std::uint64_t draws, ImpossiblePolicy policy, int kept_beliefs)
      : beliefs_(draws, policy, kept_beliefs, search_), planning_(beliefs_, search_), studies_(beliefs_) {}

  void describe(JsonWriter& json) const {
    json.begin_object().member("project", Model::project).member("horizon", Model::horizon);
    json.member("discount", Model::discount).key("actions").begin_array();
    for (int action = 0; action < Model::action_count(); ++action) {
      const int skill = Model::skill_of(action);
      json.begin_object().member("name", Model::action_name(action)).member("skill", Model::skill_name(skill));
      Model::write_parameters(action, json.key("parameters"));
      json.key("arguments").begin_object();
      for (const auto& [parameter, value] : Model::arguments_of(action)) json.member(parameter, value);
      json.end_object().end_object();
    }
    json.end_array().key("monitors").begin_array();
    for (int monitor = 0; monitor < Model::monitor_count(); ++monitor) {
      json.value(Model::action_name(first_monitor + monitor));
    }
    json.end_array().key("responses").begin_object();
    for (int skill = 0; skill < Model::skill_count; ++skill) {
      json.key(Model::skill_name(skill)).begin_array();
      for (int response = 0; response < Model::response_count(skill); ++response) {
        json.value(Model::response_name(skill, response));
      }
      json.end_array();
    }
    json.end_object().key("mission_parameters").begin_object();
    NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) { json.member(name.c_str(), leaf_text(leaf)); }};
    for (const Member& parameter : Model::mission_parameters()) {
      leaves.begin_compound();
      leaves.member(parameter.name);
      parameter.visit(parameter.constant, leaves);
      leaves.end();
    }
    json.end_object().end_object();
  }

  void answer(const Command& command, JsonWriter& json) {
    if (command.optional_text("max_seconds")) watchdog::allow(command.number<double>("max_seconds"));
    answer_to(command.name())(*this, json, command);
  }

  // From now on, answers that take long are preceded by lines of progress, one in so many milliseconds.
  static void tell_progress(JsonWriter& json, const Command& command) {
    progress::between = std::chrono::milliseconds{command.number<int>("between_ms")};
    json.begin_object().end_object();
  }

  void go_on_pondering(auto&& is_over) { planning_.go_on_pondering(is_over); }

 private:
  using Answer = void (*)(Commands& commands, JsonWriter& json, const Command& command);
  using Beliefs = BeliefCommands<Model>;
  using Planning = PlanningCommands<Model>;
  using Studies = StudyCommands<Model>;
  using Worlds = WorldCommands<Model>;

  // The answer of one part. A function without a command takes no fields.
  template <auto part, auto answer>
  static void by(Commands& commands, JsonWriter& json, const Command& command) {
    auto& answering = commands.*part;
    if constexpr (std::is_invocable_v<decltype(answer), decltype(answering), JsonWriter&, const Command&>) {
      (answering.*answer)(json, command);
    } else {
      (answering.*answer)(json);
    }
  }

  static Answer answer_to(std::string_view command) {
    static constexpr std::pair<std::string_view, Answer> table[] = {
        {"describe", [](Commands& commands, JsonWriter& json, const Command&) { commands.describe(json); }},
        {"tell_progress", [](Commands&, JsonWriter& json, const Command& command) { tell_progress(json, command); }},
        {"rate", [](Commands&, JsonWriter& json, const Command& command) { write_code_rate<Model>(json, command); }},
        {"endless_steps", [](Commands&, JsonWriter& json, const Command&) { write_endless_steps(json); }},
        {"rate_by_table",
         [](Commands&, JsonWriter& json, const Command& command) { write_table_rate<Model>(json, command); }},
        {"exact_values", by<&Commands::studies_, &Studies::exact_values>},
        {"reward_terms", by<&Commands::studies_, &Studies::reward_terms>},
        {"believe", by<&Commands::beliefs_, &Beliefs::believe>},
        {"put_aside", by<&Commands::beliefs_, &Beliefs::put_aside>},
        {"take_back", by<&Commands::beliefs_, &Beliefs::take_back>},
        {"summary", by<&Commands::beliefs_, &Beliefs::summary>},
        {"reset_belief", by<&Commands::beliefs_, &Beliefs::reset>},
        {"begin_mission", by<&Commands::beliefs_, &Beliefs::begin_mission>},
        {"condition", by<&Commands::beliefs_, &Beliefs::condition>},
        {"draw_belief", by<&Commands::beliefs_, &Beliefs::draw>},
        {"predict", by<&Commands::beliefs_, &Beliefs::predict>},
        {"update", by<&Commands::beliefs_, &Beliefs::update>},
        {"update_without_observation", by<&Commands::beliefs_, &Beliefs::update_without_observation>},
        {"export_belief", by<&Commands::beliefs_, &Beliefs::export_belief>},
        {"describe_beliefs", by<&Commands::beliefs_, &Beliefs::describe_beliefs>},
        {"import_belief", by<&Commands::beliefs_, &Beliefs::import_belief>},
        {"export_joint", by<&Commands::beliefs_, &Beliefs::export_joint>},
        {"project_belief", by<&Commands::beliefs_, &Beliefs::project_belief>},
        {"pass_time", by<&Commands::beliefs_, &Beliefs::pass_time>},
        {"marginals", by<&Commands::beliefs_, &Beliefs::marginals>},
        {"restore_belief", by<&Commands::beliefs_, &Beliefs::restore>},
        {"plan", by<&Commands::planning_, &Planning::plan>},
        {"ponder", by<&Commands::planning_, &Planning::ponder>},
        {"count_processor_time", by<&Commands::planning_, &Planning::count_processor_time>},
        {"reach", by<&Commands::planning_, &Planning::reach>},
        {"risks", by<&Commands::planning_, &Planning::risks>},
        {"may_reach_goal", by<&Commands::planning_, &Planning::may_reach_goal>},
        {"list", by<&Commands::planning_, &Planning::list>},
        {"write_listing", by<&Commands::planning_, &Planning::write_listing>},
        {"reset_world", by<&Commands::worlds_, &Worlds::reset>},
        {"begin_mission_in_world", by<&Commands::worlds_, &Worlds::begin_mission>},
        {"step_world", by<&Commands::worlds_, &Worlds::step>},
        {"show_world", by<&Commands::worlds_, &Worlds::show>},
        {"reset_worlds", by<&Commands::worlds_, &Worlds::reset_many>},
        {"step_worlds", by<&Commands::worlds_, &Worlds::step_many>},
    };
    for (const auto& [name, answer] : table) {
      if (name == command) return answer;
    }
    throw BadCommand{"unknown command: " + std::string{command}};
  }

  Planners<Model> search_;
  Beliefs beliefs_;
  Planning planning_;
  Studies studies_;
  Worlds worlds_;
};

}
