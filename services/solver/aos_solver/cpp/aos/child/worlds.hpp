// Many simulated worlds side by side, for a learner outside that acts in them. Each world has a hidden state and its
// own stream of random numbers. An observation is reported as a number: 0 for none, then the responses of all skills in
// their order. Responses of the same name are the same observation. Text responses are reported as texts.
#pragma once

#include "aos/draws/observed_numbers.hpp"
#include "aos/planning/listed/observation_numbers.hpp"
#include "aos/text/base64.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class Worlds {
 public:
  using State = typename Model::State;

  Worlds() {
    observed_.add(0, default_observation);
    for (int skill = 0; skill < Model::skill_count; ++skill) {
      has_texts_ = has_texts_ || Model::has_text_response(skill);
      for (int response = 0; response < Model::response_count(skill); ++response) observed_.add(skill, response);
    }
  }

  // Starts one new world for each seed. Writes the names of the observations, and whether some are texts.
  void reset(JsonWriter& json, const List<std::uint64_t>& seeds) {
    worlds_.clear();
    for (const std::uint64_t seed : seeds) {
      worlds_.push_back({State{}, Sampler{seed}});
      start(worlds_.back());
    }
    json.begin_object().key("observations").values(observed_.texts());
    json.member("has_texts", has_texts_).end_object();
  }

  std::size_t count() const { return worlds_.size(); }

  // Takes one action for each world; a negative action starts the world anew. The answer's arrays have an entry for
  // each world, in base64; endings are of `Ending`. Observed numbers come as arrays of their worlds, keys and values.
  void step(JsonWriter& json, const List<std::int32_t>& actions) {
    rewards_.clear();
    observations_.clear();
    endings_.clear();
    texts_.clear();
    number_worlds_.clear();
    number_keys_.clear();
    number_values_.clear();
    for (std::size_t number = 0; number < worlds_.size(); ++number) advance(number, actions[number]);
    json.begin_object().member("endings", to_base64(endings_)).member("rewards", to_base64(rewards_));
    json.member("observations", to_base64(observations_)).key("texts").values(texts_);
    if (!number_keys_.empty()) {
      json.member("number_worlds", to_base64(number_worlds_)).member("number_keys", to_base64(number_keys_));
      json.member("number_values", to_base64(number_values_));
    }
    json.end_object();
  }

 private:
  struct World {
    State state;
    Sampler random;
  };

  static void start(World& world) {
    world.state = State{};
    Model::initial(world.state, world.random);
  }

  void advance(std::size_t number, int action) {
    World& world = worlds_[number];
    Step step;
    if (action < 0) {
      start(world);
    } else {
      RecordedNumbers recorded{world.random};
      const ReportingTo reporting{world.random, &recorded};
      step = Model::step(world.state, action, world.random);
      for (const auto& [key, value] : recorded.numbers()) {
        number_worlds_.push_back(static_cast<std::int32_t>(number));
        number_keys_.push_back(key);
        number_values_.push_back(value);
      }
    }
    rewards_.push_back(step.reward);
    endings_.push_back(static_cast<std::uint8_t>(Model::ending(world.state)));
    const bool is_named = step.observation >= 0;
    const std::uint32_t observation = is_named ? observed_.add(Model::skill_of(action), step.observation) : 0;
    observations_.push_back(static_cast<std::int32_t>(observation));
    if (has_texts_) texts_.emplace_back(is_named ? observed_[observation] : observation_text(step.observation));
  }

  ObservationNumbers<Model> observed_;
  bool has_texts_ = false;
  List<World> worlds_;

  List<double> rewards_;
  List<std::int32_t> observations_;
  List<std::uint8_t> endings_;
  List<std::string> texts_;
  List<std::int32_t> number_worlds_;
  List<NumberKey> number_keys_;
  List<double> number_values_;
};

}
