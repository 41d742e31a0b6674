// The commands for simulated worlds: one world for missions without a robot, many worlds for a learner.
#pragma once

#include "aos/belief/risks.hpp"
#include "aos/child/command.hpp"
#include "aos/child/wording.hpp"
#include "aos/child/worlds.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/draws/replay.hpp"
#include "aos/text/base64.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class WorldCommands {
 public:
  void reset(JsonWriter& json, const Command& command) {
    random_ = Sampler{command.number<std::uint64_t>("seed")};
    hidden_ = State{};
    Model::initial(hidden_, random_);
    json.begin_object().member("ending", ending_text(Model::ending(hidden_))).end_object();
  }

  // Begins another mission in the world as it is, after `idle` steps of extrinsic changes alone.
  void begin_mission(JsonWriter& json, const Command& command) {
    Replay draws;
    const List<double> none;
    draws.start(none, random_);
    Model::begin(hidden_, command.number<int>("idle"), draws);
    json.begin_object().member("ending", ending_text(Model::ending(hidden_)));
    if (Model::constraint_count() > 0) {
      json.member("conditions", std::uint64_t{Model::violations(hidden_, hidden_, 0)});
    }
    json.end_object();
  }

  void step(JsonWriter& json, const Command& command) {
    const int action = action_of<Model>(command);
    RecordedNumbers recorded{random_};
    const ReportingTo reporting{random_, &recorded};
    const State before = hidden_;
    const Step step = Model::step(hidden_, action, random_);
    json.begin_object().member("reward", step.reward).member("response", text_of_response<Model>(action, step.observation));
    json.member("ending", ending_text(Model::ending(hidden_)));
    json.member("violations", std::uint64_t{violations_of<Model>(before, hidden_, action)});
    write_numbers(json.key("numbers"), recorded.numbers());
    json.end_object();
  }

  void show(JsonWriter& json) const { json.begin_object().member("state", Model::state_text(hidden_)).end_object(); }

  void reset_many(JsonWriter& json, const Command& command) {
    List<std::uint64_t> seeds;
    for (const auto seed : command.items()) seeds.push_back(detail::number_in<std::uint64_t>(seed));
    worlds_.reset(json, seeds);
  }

  // The field `actions` is an array of 32-bit numbers in base64, one for each world.
  void step_many(JsonWriter& json, const Command& command) {
    const auto actions = from_base64<std::int32_t>(command.text("actions"));
    if (!actions || actions->size() != worlds_.count()) throw BadCommand{"not one action for each world"};
    for (const std::int32_t action : *actions) checked_action<Model>(std::max(action, 0));
    worlds_.step(json, *actions);
  }

 private:
  using State = typename Model::State;

  State hidden_{};
  Sampler random_{0};
  Worlds<Model> worlds_;
};

}
