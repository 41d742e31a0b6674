// The commands that ask an engine child about its belief or change the belief.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "aos/base/fault.hpp"
#include "aos/base/json.hpp"
#include "aos/base/observed_numbers.hpp"
#include "aos/belief/belief.hpp"
#include "aos/belief/kept_beliefs.hpp"
#include "aos/child/command.hpp"
#include "aos/child/left_out.hpp"
#include "aos/child/saved_beliefs.hpp"
#include "aos/child/wording.hpp"
#include "aos/model/blame.hpp"
#include "aos/planning/planner.hpp"

namespace aos {

template <class Model>
class BeliefCommands {
 public:
  using State = typename Model::State;

  // `kept_beliefs` is the path of the file of KeptBeliefs. `search` follows the changes of the belief.
  BeliefCommands(std::uint64_t seed, ImpossiblePolicy policy, const char* kept_beliefs, Planner<Model>& search)
      : random_(seed), policy_(policy), belief_(Belief<Model>::initial(random_)), kept_(kept_beliefs), search_(search) {}

  const Belief<Model>& belief() const { return belief_; }

  void reset(JsonWriter& json) {
    impossible_in_a_row_ = 0;
    become(json, Belief<Model>::initial(random_), [&] { search_.start_over(); });
  }

  // Makes the belief the initial belief in particles, even where enumeration gives it exactly: tests compare the two.
  void draw(JsonWriter& json) { become(json, Belief<Model>::drawn(random_)); }

  // Writes the probability of each observation after an action.
  void write_predicted(JsonWriter& json, int action) {
    json.begin_array();
    for (const auto& [observation, probability] : belief_.observations(action, random_)) {
      json.begin_object().member("response", text_of_response<Model>(action, observation));
      json.member("probability", probability).end_object();
    }
    json.end_array();
  }
  void predict(JsonWriter& json, const Command& command) {
    json.begin_object().key("predicted");
    write_predicted(json, action_of<Model>(command));
    json.end_object();
  }

  // Updates the belief by a response and the `numbers` observed with it. If no step of the model reports just these
  // numbers, the response counts alone. `locals`, if given, are values of the mapping's local variables; they correct
  // the belief. A fault of this correction is told in the answer, and the belief stays uncorrected.
  void update(JsonWriter& json, const Command& command) {
    const int action = action_of<Model>(command);
    const Observation observation = observation_of<Model>(action, command.text("response"));
    const ObservedNumbers numbers = numbers_from(command.text("numbers"));
    const auto locals = command.optional_text("locals");
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
      ++impossible_in_a_row_;
      become(json, after_impossible(action));
    } else {
      impossible_in_a_row_ = 0;
      become(json, std::move(posterior), [&] { search_.move_to(action, observation); });
    }
    json.end_object();
  }

  // Updates the belief after an action that ran only with probability `ran_probability`.
  void update_without_observation(JsonWriter& json, const Command& command) {
    const int action = action_of<Model>(command);
    json.begin_object().member("log_probability", 0.0).member("is_impossible", false);
    become(json.key("summary"), belief_.predicted(action, random_, command.number<double>("ran_probability")));
    json.end_object();
  }

  // Writes the particles from `first` on. Unless `is_whole`, variables that do not matter have stand-ins.
  void export_belief(JsonWriter& json, const Command& command) const {
    const LeftOut<Model> left_out;
    const bool is_whole = command.flag("is_whole");
    save_belief(json, belief_, command.number<std::size_t>("first"),
                [&](const State& state) { return is_whole ? state : left_out.rest_of(state); });
  }

  void import_belief(JsonWriter& json, const Command& command) {
    auto belief = load_belief<Model>(command.number<double>("error_bound"), command.flag("is_drawn"),
                                     command.text("history"), command.number<std::size_t>("constants"), command.items());
    if (belief.particles().empty()) throw BadCommand{"an empty belief"};
    become(json, std::move(belief));
  }

  // Takes over the belief that an earlier engine kept after change number `change`.
  void restore(JsonWriter& json, const Command& command) {
    auto kept = kept_.restore(command.number<std::uint64_t>("change"));
    if (!kept) throw BadCommand{"that belief was not kept"};
    belief_ = *std::move(kept);
    search_.forget();
    json.begin_object().end_object();
  }

 private:
  // Why an observation did not correct the belief. The code is empty if it did.
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
      const typename Model::Correcting correcting{observation};
      // A replay of this step would not be corrected, so the corrected belief has no history.
      const auto [posterior, log_probability] = belief_.without_history().posterior(action, observation, numbers, random_);
      return {posterior.without_history(), log_probability};
    } catch (const ModelFault& fault) {
      uncorrected = {fault.code, fault.text, blame::piece()};
    } catch (const std::exception& error) {
      uncorrected = {"AOS215", error.what(), blame::piece()};
    }
    return belief_.posterior(action, observation, numbers, random_);
  }

  // Takes over a belief and writes its summary. If the summary fails, nothing changes.
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

  // The belief after an observation that was impossible under it. hold: the predicted belief, as if nothing
  // were observed. widen: one half is the predicted belief, one quarter each the belief before and the
  // initial belief. reset: the initial belief.
  //
  // A drawn belief may only have had too few particles, and a mixed belief can be moved no more (moves.hpp).
  // So a drawn belief is held at the first impossible observations in a row.
  Belief<Model> after_impossible(int action) {
    const Belief<Model> initial = Belief<Model>::initial(random_);
    if (policy_ == ImpossiblePolicy::reset) return initial;
    const Belief<Model> predicted = belief_.predicted(action, random_);
    const bool may_be_too_few = belief_.is_drawn() && impossible_in_a_row_ <= held_in_a_row;
    if (policy_ == ImpossiblePolicy::hold || may_be_too_few) return predicted;
    return predicted.mixed_with(belief_.mixed_with(initial, 0.5), 0.5);
  }

  static constexpr int held_in_a_row = 8;

  Sampler random_;
  ImpossiblePolicy policy_;
  int impossible_in_a_row_ = 0;
  Belief<Model> belief_;
  KeptBeliefs<Model> kept_;
  Planner<Model>& search_;
};

}  // namespace aos
