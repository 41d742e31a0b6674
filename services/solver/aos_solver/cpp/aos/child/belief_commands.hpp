// The commands that ask an engine child about its belief or change the belief.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/belief/effort.hpp"
#include "aos/belief/hypotheses.hpp"
#include "aos/belief/kept_beliefs.hpp"
#include "aos/child/command.hpp"
#include "aos/child/faults.hpp"
#include "aos/child/jeffreys_rule.hpp"
#include "aos/child/left_out.hpp"
#include "aos/child/projected_beliefs.hpp"
#include "aos/child/saved_beliefs.hpp"
#include "aos/child/wording.hpp"
#include "aos/draws/observed_numbers.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/violations.hpp"
#include "aos/planning/planners.hpp"
#include "aos/text/base64.hpp"
#include "aos/text/json.hpp"

namespace aos {

template <class Model>
class BeliefCommands {
 public:
  using State = typename Model::State;

  // `draws` is the seed of what the initial belief draws. `kept_beliefs` is the descriptor of KeptBeliefs. `search` follows
  // the changes of the belief.
  BeliefCommands(std::uint64_t draws, ImpossiblePolicy policy, int kept_beliefs, Planners<Model>& search)
      : random_(draws), policy_(policy), believed_(Belief<Model>::initial(random_)), kept_(kept_beliefs), search_(search) {}

  const Belief<Model>& belief() const { return believed_.belief(); }
  // Null where nothing sets it apart from the belief.
  const Belief<Model>* cautious() const { return believed_.cautious(); }
  // The belief that a command is about: its flag `cautious` asks for the one in which nothing ran that was not observed.
  const Belief<Model>& belief_for(const Command& command) const { return belief_for(command, believed_); }

  void summary(JsonWriter& json) const { believed_.write_summary(json); }

  void reset(JsonWriter& json, const Command& command) {
    begin_change(command);
    impossible_in_a_row_ = 0;
    become(json, Hypotheses{Belief<Model>::initial(random_)}, [&] { search_.start_over(); });
  }

  // Begins another mission from what is believed, after `idle` steps of extrinsic changes alone.
  void begin_mission(JsonWriter& json, const Command& command) {
    begin_change(command);
    impossible_in_a_row_ = 0;
    become(json, believed_.begun(command.number<int>("idle"), random_), [&] { search_.start_over(); });
  }

  // Conditions on all that this model's constraints say of a state; they are conditions here (conditions.py). Writes their
  // joint probability. If it is 0, nothing changes.
  void condition(JsonWriter& json, const Command& command) {
    kept_.number_next(command.number<std::uint64_t>("change"));
    const auto all = static_cast<Violations>((std::uint64_t{1} << Model::constraint_count()) - 1);
    auto found = believed_.posteriors([&](const Belief<Model>& belief) {
      return belief.conditioned([&](const State& state) { return Model::violations(state, state, 0) == all; });
    });
    const bool is_possible = !found.hypotheses_are_empty();
    json.begin_object().member("probability", is_possible ? std::exp(believed_.log_probability(found)) : 0.0);
    json.key("summary");
    if (is_possible) become(json, believed_.known(std::move(found), command.number<double>("refuted_below")));
    else become(json, believed_, [] {});
    json.end_object();
  }

  // Makes the belief the initial belief in particles, even where enumeration gives it exactly: tests compare the two.
  void draw(JsonWriter& json, const Command& command) {
    begin_change(command);
    become(json, Hypotheses{Belief<Model>::drawn(random_)});
  }

  // Writes the probability of each observation after an action. The draws of a prediction are not those of the beliefs.
  static void write_predicted(JsonWriter& json, int action, const Belief<Model>& belief, std::uint64_t seed) {
    Sampler random{mixed(seed, prediction)};
    json.begin_array();
    for (const auto& [observation, probability] : belief.observations(action, random)) {
      json.begin_object().member("response", text_of_response<Model>(action, observation));
      json.member("probability", probability).end_object();
    }
    json.end_array();
  }
  void predict(JsonWriter& json, const Command& command) const {
    json.begin_object().key("predicted");
    write_predicted(json, action_of<Model>(command), belief_for(command), command.number<std::uint64_t>("seed"));
    json.end_object();
  }

  // Updates the belief by a response and the `numbers` observed with it. If no step of the model reports just these
  // numbers, the response counts alone. `locals`, if given, are values of the mapping's local variables; they correct
  // the belief. A fault of this correction is told in the answer, and the belief stays uncorrected. `refuted_below` is
  // explained in hypotheses.hpp.
  void update(JsonWriter& json, const Command& command) {
    begin_change(command);
    update_effort = {};
    const int action = action_of<Model>(command);
    const Observation observation = observation_of<Model>(action, command.text("response"));
    Fault uncorrected;  // without a code where nothing went wrong
    bool has_other_numbers = false;
    auto found = posteriors_of(command, action, observation, has_other_numbers, uncorrected);
    const bool is_impossible = found.are_empty();
    if (!is_monitor(action)) impossible_in_a_row_ = is_impossible ? impossible_in_a_row_ + 1 : 0;
    // A drawn belief may only have had too few particles, and a mixed one can be moved no more (moves.hpp). So the first
    // impossible observations in a row are left out.
    const bool may_be_too_few = belief().is_drawn() && impossible_in_a_row_ <= left_out_in_a_row;
    const bool is_left_out = is_impossible && may_be_too_few && policy_ != ImpossiblePolicy::reset;
    const Report report{Model::skill_name(Model::skill_of(action)),
                        std::string{command.text("response")} + '\n' + std::string{command.text("numbers")}};
    json.begin_object().member("log_probability", is_impossible ? 0 : believed_.log_probability(found));
    json.member("is_impossible", is_impossible);
    json.member("is_excluded", !is_left_out && believed_.excludes(found, report));
    json.member("has_other_numbers", has_other_numbers && !is_impossible);
    json.member("effort", update_effort.text());
    if (!uncorrected.code.empty()) {
      json.key("uncorrected").begin_object();
      write_members(json, uncorrected);
      json.end_object();
    }
    json.key("summary");
    if (is_left_out) {
      become(json, believed_.unread(action, random_));
    } else if (is_impossible) {
      become(json, believed_.remedied(report, after_impossible(action)));
    } else {
      const bool is_by_bayes = !found.hypotheses_are_empty() && !believed_.excludes(found, report) && !is_monitor(action);
      auto after = believed_.given(Model::skill_of(action), report, std::move(found), command.number<double>("refuted_below"));
      become(json, std::move(after), [&] { is_by_bayes ? search_.move_to(action, observation) : search_.forget(); });
    }
    json.end_object();
  }

  // Updates the belief after an action that ran only with probability `ran_probability`.
  void update_without_observation(JsonWriter& json, const Command& command) {
    begin_change(command);
    become_unobserved(json, believed_.unobserved(action_of<Model>(command), command.number<double>("ran_probability"), random_));
  }

  // Writes the particles from `first` on, of the belief or of the one with this `number` among those of `describe_beliefs`.
  // Unless `is_whole`, variables that do not matter have stand-ins. Where all would take more than `max_bytes`, some are
  // missing.
  void export_belief(JsonWriter& json, const Command& command) const {
    const LeftOut<Model> left_out;
    const bool is_whole = command.flag("is_whole");
    save_belief(json, command.optional_text("number") ? belief_by_number(command) : belief_for(command), command.number<std::size_t>("first"),
                [&](const State& state) { return is_whole ? state : left_out.rest_of(state); },
                command.optional_text("max_bytes") ? command.number<std::size_t>("max_bytes") : max_answer_bytes);
  }
  // Writes how many beliefs there are, and what tells them apart.
  void describe_beliefs(JsonWriter& json) const {
    json.begin_object().member("beliefs", believed_.beliefs().size());
    json.member("words", to_base64(believed_.words())).end_object();
  }

  // Lets the time of a step pass in which nothing is done and nothing is observed.
  void pass_time(JsonWriter& json, const Command& command) {
    begin_change(command);
    become_unobserved(json, believed_.passed(random_));
  }

  // Writes the marginals of all variables, with so many `values` in all.
  void marginals(JsonWriter& json, const Command& command) const {
    const auto values = command.number<std::size_t>("values");
    Marginals<Model>{belief().particles()}.write(json.begin_object().key("marginals"), values, values);
    json.end_object();
  }

  // Writes the joint distribution of some variables under the belief with this `number`; see projected_beliefs.hpp.
  void export_joint(JsonWriter& json, const Command& command) const {
    save_joint(json, command, belief_by_number(command));
  }

  // Takes over a belief, or one of several: these come one after the other, and with the last of them (`left` is 0) all
  // are taken over. `words` tells them apart. With `project_belief` they come from an engine with other variables.
  void import_belief(JsonWriter& json, const Command& command) {
    take_over(json, command,
              load_belief<Model>(command.number<double>("error_bound"), command.flag("is_drawn"), command.text("history"),
                                 command.number<std::size_t>("constants"), command.items()));
  }
  void project_belief(JsonWriter& json, const Command& command) {
    random_ = Sampler{command.number<std::uint64_t>("draws")};
    take_over(json, command, load_joint<Model>(command, random_));
  }

  // Moves the probability that a variable has a value, of the belief that the command is about, and keeps all ratios
  // among the states where it has the value, and among the others (Jeffrey's rule). With `from_aside` the belief is the
  // one that was put aside. Writes the probability before. Where that excludes the value or its contrary and another
  // probability is wanted, nothing changes.
  void believe(JsonWriter& json, const Command& command) {
    kept_.number_next(command.number<std::uint64_t>("change"));
    const bool is_from_aside = command.optional_text("from_aside") && command.flag("from_aside");
    if (is_from_aside && !aside_) throw BadCommand{"no belief was put aside"};
    const JeffreysRule<Model> rule{belief_for(command, is_from_aside ? *aside_ : believed_), command.text("variable"), command.text("value")};
    const auto moved = rule.moved_to(command.number<double>("probability"));
    json.begin_object().member("probability", rule.probability()).member("has_variable", rule.has_variable());
    json.key("summary");
    if (moved) become(json, Hypotheses{*moved});
    else become(json, believed_, [] {});
    json.end_object();
  }
  void put_aside(JsonWriter& json) {
    aside_ = believed_;
    json.begin_object().end_object();
  }
  void take_back(JsonWriter& json, const Command& command) {
    kept_.number_next(command.number<std::uint64_t>("change"));
    if (!aside_) throw BadCommand{"no belief was put aside"};
    become(json, *aside_);
  }

  // Takes over what an earlier engine kept after change number `change`.
  void restore(JsonWriter& json, const Command& command) {
    auto kept = kept_.restore(command.number<std::uint64_t>("change"));
    if (!kept) throw BadCommand{"that belief was not kept"};
    believed_ = *std::move(kept);
    impossible_in_a_row_ = believed_.impossible_in_a_row();
    search_.forget();
    json.begin_object().end_object();
  }

 private:
  using Hypotheses = aos::Hypotheses<Model>;

  static const Belief<Model>& belief_for(const Command& command, const Hypotheses& believed) {
    const bool is_cautious = command.optional_text("cautious") && command.flag("cautious");
    return is_cautious && believed.cautious() != nullptr ? *believed.cautious() : believed.belief();
  }
  const Belief<Model>& belief_by_number(const Command& command) const {
    const auto all = believed_.beliefs();
    const auto number = command.number<std::size_t>("number");
    if (number >= all.size()) throw BadCommand{"there is no such belief"};
    return *all[number];
  }
  // Each change draws from a stream of its own, so that it comes out the same whatever this process did before.
  void begin_change(const Command& command) {
    random_ = Sampler{command.number<std::uint64_t>("draws")};
    kept_.number_next(command.number<std::uint64_t>("change"));
  }

  void take_over(JsonWriter& json, const Command& command, Belief<Model> belief) {
    if (belief.particles().empty()) throw BadCommand{"an empty belief"};
    const bool is_one_of_many = command.optional_text("left").has_value();
    if (is_one_of_many && command.flag("is_first")) incoming_.clear();
    incoming_.push_back(std::move(belief));
    if (is_one_of_many && command.number<int>("left") > 0) {
      json.begin_object().end_object();
      return;
    }
    kept_.number_next(command.number<std::uint64_t>("change"));
    List<Belief<Model>> all = std::exchange(incoming_, {});
    if (!is_one_of_many) return become(json, Hypotheses{std::move(all.back())});
    if (all.size() != command.number<std::size_t>("beliefs")) throw BadCommand{"some of the beliefs are missing"};
    const auto words = from_base64<std::uint64_t>(command.text("words"));
    become(json, Hypotheses::of(std::move(all), words.value_or(Words{})));
  }

  // What a response makes of all that is believed, with the numbers beside it, or alone where no step reports just these.
  Posteriors<Model> posteriors_of(const Command& command, int action, Observation observation, bool& has_other_numbers, Fault& uncorrected) {
    const ObservedNumbers numbers = numbers_from(command.text("numbers"));
    const auto locals = command.optional_text("locals");
    const auto by = [&](const Belief<Model>& belief, auto&& sink) {
      return locals ? corrected_posterior(belief, action, observation, sink, *locals, uncorrected)
                    : belief.posterior(action, observation, sink, random_);
    };
    auto found = believed_.posteriors([&](const Belief<Model>& belief) { return by(belief, WeighedNumbers{numbers}); });
    if (!found.are_empty() || Model::number_count(Model::skill_of(action)) == 0) return found;
    has_other_numbers = believed_.posteriors([&](const Belief<Model>& belief) {
      WeighedNumbers reported{numbers, /*by_value=*/false};
      return belief.posterior(action, observation, reported, random_);
    }).are_empty();
    if (has_other_numbers) found = believed_.posteriors([&](const Belief<Model>& belief) { return by(belief, ignored_numbers); });
    return found;
  }

  std::pair<Belief<Model>, double> corrected_posterior(const Belief<Model>& belief, int action, Observation observation,
                                                       auto& numbers, std::string_view locals, Fault& uncorrected) {
    try {
      Model::read_locals(action, locals);
      const typename Model::Correcting correcting{observation};
      // A replay of this step would not be corrected, so the corrected belief has no history.
      const auto [posterior, log_probability] = belief.without_history().posterior(action, observation, numbers, random_);
      return {posterior.without_history(), log_probability};
    } catch (const ModelFault&) {
      uncorrected = current_fault();
    } catch (const std::exception&) {
      if (blame::piece() == 0) throw;
      uncorrected = current_fault();
    }
    return belief.posterior(action, observation, numbers, random_);
  }

  // Answers like `update`, where nothing was observed.
  void become_unobserved(JsonWriter& json, Hypotheses believed) {
    json.begin_object().member("log_probability", 0.0).member("is_impossible", false);
    become(json.key("summary"), std::move(believed));
    json.end_object();
  }
  // Takes over what is believed and writes its summary. If the summary fails, nothing changes.
  void become(JsonWriter& json, Hypotheses believed) {
    become(json, std::move(believed), [&] { search_.forget(); });
  }
  void become(JsonWriter& json, Hypotheses believed, auto&& follow) {
    believed.note_impossible(impossible_in_a_row_);
    believed.write_summary(json);
    believed_ = std::move(believed);
    kept_.keep(believed_);
    follow();
  }

  // The belief after an observation that was impossible under it. hold: the predicted belief, as if nothing
  // were observed. widen: one half is the predicted belief, one quarter each the belief before and the
  // initial belief. reset: the initial belief.
  Belief<Model> after_impossible(int action) {
    const Belief<Model> initial = Belief<Model>::initial(random_);
    if (policy_ == ImpossiblePolicy::reset) return initial;
    const Belief<Model> predicted = belief().predicted(action, random_);
    if (policy_ == ImpossiblePolicy::hold) return predicted;
    return predicted.mixed_with(belief().mixed_with(initial, 0.5), 0.5);
  }

  static constexpr int left_out_in_a_row = 8;
  static constexpr std::uint64_t prediction = 1;

  Sampler random_;
  ImpossiblePolicy policy_;
  int impossible_in_a_row_ = 0;
  Hypotheses believed_;
  std::optional<Hypotheses> aside_;
  List<Belief<Model>> incoming_;
  KeptBeliefs<Model> kept_;
  Planners<Model>& search_;
};

}
