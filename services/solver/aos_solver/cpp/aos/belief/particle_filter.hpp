// The particle filter of beliefs that cannot be enumerated. All limits are numbers of steps, so that a seed gives one belief.
//
// Each particle makes trials in proportion to its weight, and at least one. If many steps agree with the observation, or if the
// last draw has too many outcomes to guide any, a trial draws the whole step (the bootstrap filter: Gordon, Salmond and Smith,
// 1993). Otherwise it is guided towards the observation and weighted (guided_step.hpp). Equal states are merged, and light
// particles are thinned out (gathering.hpp). Particles are moved (moves.hpp) if too few agree, if they are worth too few samples,
// or if they descend from too few origins.
#pragma once

#include "aos/belief/effort.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/guided_step.hpp"
#include "aos/belief/history.hpp"
#include "aos/belief/moves.hpp"
#include "aos/draws/replay.hpp"

namespace aos {

inline constexpr std::size_t pilot_count = 200;         // steps that tell how likely an observation is
inline constexpr double rare_observation = 0.25;        // an observation in fewer of all steps
inline constexpr std::size_t few_particles = 300;       // more have a trial each, if affordable
inline constexpr std::size_t few_states = 500;
inline constexpr std::size_t max_guesses = 500;         // about
inline constexpr std::size_t max_guessing_runs = 500'000;
inline constexpr std::size_t price_count = 50;          // trials that tell how many runs one takes
inline constexpr double max_guided_runs = 150'000;      // of an update that covers few particles, or guides nothing
inline constexpr double max_covering_runs = 2'000'000;  // of one that covers many
inline constexpr double dear_trial = 50;                // in runs; cheap trials can be many
inline constexpr double nearly_all = 1 - 1e-8;          // of the weight, which is covered
inline constexpr double few_effective = 0.2 * particle_count;
inline constexpr double few_origins = 250;
inline constexpr double too_few_effective = 250;
inline constexpr double least_gain = 0.8;               // of moves; those that lose more are not taken
inline constexpr double surprise = 0.75;                // an observation that leaves less of the effective samples
inline constexpr std::size_t rescue_effort = 4;         // of moves before an observation
inline constexpr int max_rescues = 2;
inline constexpr int max_rescues_of_none = 3;           // if no particle is left

template <class Model>
class ParticleFilter {
 public:
  using State = typename Model::State;
  using Updated = UpdatedCloud<Model>;

  explicit ParticleFilter(Sampler& random) : random_(random) {}

  // Draws the documents' initial belief. If the belief has few states, more draws of it take no more room.
  Cloud<Model> initial() {
    GatheredCloud<Model> gathered;
    State state{};
    const auto wants_more = [&](std::size_t drawn) {
      return drawn < 10 * particle_count ? gathered.size() < particle_count
                                         : drawn < 40 * particle_count && gathered.size() <= few_states;
    };
    for (std::size_t drawn = 0; wants_more(drawn); ++drawn) {
      Block block = free_block();
      Model::initial(state, replay_);
      block.draws = replay_.draws();
      gathered.add(state, 1.0, 1.0, begun_trace(std::move(block)), random_);
    }
    History<Model> history;
    if (gathered.size() <= few_states) history.note_all_origins();
    return gathered.thinned(particle_count, std::move(history), random_);
  }

  // Begins a history with particles. Their weights are known exactly, or are worth one sample each.
  Cloud<Model> begun(const List<Particle<Model>>& particles, bool exact) {
    Cloud<Model> cloud{particles, {}, History<Model>{particles}};
    if (particles.size() <= few_states) cloud.history.note_all_origins();
    for (std::size_t i = 0; i < particles.size(); ++i) {
      Block block{{cloud.history.origin_value(i, random_)}, 0, 1, 1};
      cloud.lineages.push_back({exact ? 0 : particles[i].weight * particles[i].weight, begun_trace(std::move(block))});
    }
    return cloud;
  }

  // Updates a cloud by a step. The result has no particles if no trial gave what was observed.
  Updated after(Cloud<Model> before, HistoryStep step, NumberSink& numbers) {
    const ForgottenTexts forgotten;
    numbers_ = &numbers;
    replay_.report_to(numbers_);
    if (before.history.steps().size() >= max_history) before = begun(before.particles, false);
    Updated updated = propagated(before, step);
    const bool is_worth_moving = !before.history.steps().empty() || before.history.begins_with_the_documents();
    // The samples that agree with a rare observation are few. More of them agree if there were more before it. Moves after
    // it may not help: it may leave states that no move connects. An observation that tells little needs no such rescue.
    const double enough = std::min(too_few_effective, surprise * before.effective());
    for (int rescue = 0; step.is_observed && is_worth_moving; ++rescue) {
      if (updated.cloud.effective() >= enough) break;
      if (rescue >= (updated.cloud.particles.empty() ? max_rescues_of_none : max_rescues)) break;
      before = moved(before, updated.cloud.effective(), rescue_effort);
      Updated again = propagated(before, step);
      if (again.cloud.effective() >= updated.cloud.effective()) updated = std::move(again);
    }
    if (!updated.cloud.particles.empty() && step.is_observed) move_where_few(updated.cloud);
    return updated;
  }

  // Calls `visit(observation, weight)` for steps at random; the weights sum to 1.
  void draw_observations(const List<Particle<Model>>& particles, int action, auto&& visit) {
    draw_evenly<Model>(particles, particle_count, random_, [&](const State& drawn) {
      State next = drawn;
      visit(Model::step(next, action, random_).observation, 1.0 / particle_count);
    });
  }

 private:
  // How trials are made, and how many of each particle on average.
  struct Plan {
    bool is_guided = false;
    std::size_t by_chance = 0;
    List<double> trials;
  };

  // Notes how many outcomes each draw has, 0 for a continuous one, and whether a text is begun.
  class Look final : public DrawWatcher {
   public:
    void before_draw(std::size_t, const double* weights, int count, double) override {
      const auto positive = std::count_if(weights, weights + count, [](double weight) { return weight > 0; });
      draws_.push_back({weights == nullptr ? 0 : static_cast<int>(positive), is_text_begun()});
    }
    // How many of the draws since the last call come before those that are guided. Draws are guided from the
    // beginning of a text on, or else at the end, and so are as many before these as have few combinations.
    std::size_t first_guided() {
      const auto begun = std::find_if(draws_.begin(), draws_.end(), [](const Draw& draw) { return draw.is_text_begun; });
      std::size_t first = begun - draws_.begin();
      for (long combinations = 1; first > 0; --first) {
        const int outcomes = draws_[first - 1].outcomes;
        combinations *= outcomes > 0 ? outcomes : max_branches;
        if (combinations > max_branches) break;
      }
      draws_.clear();
      return first;
    }

   private:
    struct Draw {
      int outcomes;
      bool is_text_begun;
    };
    List<Draw> draws_;
  };

  Block free_block() {
    Block block;
    block.seed = random_.bits();
    chance_ = Sampler{block.seed};
    replay_.start(none_, chance_);
    return block;
  }

  // The cloud after moves, since so many effective samples remained.
  Cloud<Model> moved(const Cloud<Model>& cloud, double effective, std::size_t effort) {
    Moves<Model> moves{cloud.history, random_};
    Cloud<Model> after = moves.moved(cloud, effort);
    update_effort.note_move(moves.copies(), effective, moves.steps());
    return after;
  }

  void move_where_few(Cloud<Model>& cloud) {
    const bool is_few = cloud.effective() < few_effective;
    if (!is_few && (cloud.history.has_all_origins() || cloud.effective_origins() >= few_origins)) return;
    if (!cloud.history.is_time_to_move()) return;
    Cloud<Model> after = moved(cloud, cloud.effective(), 1);
    const double gain = is_few ? after.effective() / cloud.effective()
                               : after.effective_origins() / cloud.effective_origins();
    // Moved particles are mixed better than they were, also where they are worth as many samples. To take only what gains would
    // prefer beliefs that are more even.
    if (gain >= least_gain) cloud = std::move(after);
    cloud.history.note_moves(gain > 1.1);
  }

  Plan plan_of(const Cloud<Model>& before, const HistoryStep& step) {
    if (!step.is_observed) return {false, 0, by_weight(before, wanted(before))};
    Look look;
    List<std::size_t> first_guided;
    std::size_t agreed = 0;
    bool has_guided = false;
    draw_evenly<Model>(before.particles, pilot_count, random_, [&](const State& drawn) {
      State next = drawn;
      replay_.start(none_, random_, nullptr, &look);
      agreed += Model::step(next, step.action, replay_).observation == step.observation && replay_.weight() > 0 ? 1 : 0;
      first_guided.push_back(look.first_guided());
      has_guided = has_guided || first_guided.back() < replay_.draws();
    });
    std::nth_element(first_guided.begin(), first_guided.begin() + pilot_count / 2, first_guided.end());
    const double share = static_cast<double>(agreed) / pilot_count;
    const std::size_t by_chance = first_guided[pilot_count / 2];
    if (by_chance > 0 && (share >= rare_observation || !has_guided)) {
      return {false, 0, by_weight(before, std::min(wanted(before) / std::max(share, 1.0 / pilot_count), max_guided_runs))};
    }
    return {true, by_chance, by_promise(before, step, by_chance)};
  }

  // How many agreeing trials are wanted. If there are few states, more trials take no more room.
  static double wanted(const Cloud<Model>& before) {
    return before.particles.size() <= few_states ? 4.0 * particle_count : particle_count;
  }

  // Trials in proportion to the weights, at least one for each particle.
  static List<double> by_weight(const Cloud<Model>& before, double all) {
    List<double> trials;
    const double total = before.total();
    for (const auto& particle : before.particles) trials.push_back(std::max(1.0, all * particle.weight / total));
    return trials;
  }

  // Trials in proportion to the weights and to a rough estimate of the observation's likelihood from each
  // particle (as the auxiliary particle filter: Pitt and Shephard, 1999). A few trials follow the weights
  // alone. If there are many particles, one trial for each tells more.
  List<double> by_promise(const Cloud<Model>& before, const HistoryStep& step, std::size_t by_chance) {
    GuidedStep<Model> guided{step.action, step.observation, numbers_, random_};
    guided.leave_to_chance(by_chance);
    const auto nothing = [](const State&, double, const List<double>&) {};
    if (before.particles.size() > few_particles) {
      draw_evenly<Model>(before.particles, price_count, random_, [&](const State& drawn) { guided.from(drawn, nothing); });
      const double price = static_cast<double>(guided.runs()) / price_count;
      const bool are_dear = price > dear_trial;
      if (are_dear && price * before.particles.size() <= max_covering_runs) return by_weight(before, few_particles);
    }
    const std::size_t guesses = std::clamp<std::size_t>(max_guesses / before.particles.size(), 1, 8);
    List<double> trials;
    double sum = 0;
    double guessed = 0;
    for (const auto& particle : before.particles) {
      double guess = sum / std::max(guessed, 1e-300);
      if (guided.runs() < max_guessing_runs) {
        guess = 0;
        for (std::size_t i = 0; i < guesses; ++i) guess += guided.from(particle.state, nothing, 1);
        sum += particle.weight * guess;
        guessed += particle.weight;
      }
      trials.push_back(particle.weight * guess);
    }
    const double total = before.total();
    double promised = 0;
    for (const double promise : trials) promised += promise;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      const double by_weight = before.particles[i].weight / total;
      trials[i] = promised > 0 ? 0.98 * trials[i] / promised + 0.02 * by_weight : by_weight;
    }
    update_effort.steps += guided.runs();
    return priced(before, std::move(trials), guided);
  }

  // As many trials as the budget allows, in these shares. Each of the particles that make up nearly all of
  // the shares has at least one trial.
  List<double> priced(const Cloud<Model>& before, List<double> shares, GuidedStep<Model>& guided) {
    List<Particle<Model>> promising;
    for (std::size_t i = 0; i < shares.size(); ++i) promising.push_back({before.particles[i].state, shares[i]});
    const std::size_t runs_before = guided.runs();
    double outcomes = 1;
    draw_evenly<Model>(promising, price_count, random_, [&](const State& drawn) {
      guided.from(drawn, [&](const State&, double, const List<double>&) { ++outcomes; });
    });
    const double price = static_cast<double>(guided.runs() - runs_before) / price_count;
    List<double> sorted = shares;
    std::sort(sorted.begin(), sorted.end());
    std::reverse(sorted.begin(), sorted.end());
    double light = 1 - nearly_all;
    std::size_t covered = sorted.size();
    while (covered > 0 && (light -= sorted[covered - 1]) > 0) --covered;
    covered = std::min(covered, static_cast<std::size_t>(max_covering_runs / price));
    const double min_share = covered > 0 ? sorted[covered - 1] : 1;
    const double runs = max_guided_runs * wanted(before) / particle_count;
    const double all = std::min(runs / price, wanted(before) * price_count / outcomes);
    for (double& share : shares) share = std::max(all * share, share >= min_share ? 1.0 : 0.0);
    return shares;
  }

  Updated propagated(const Cloud<Model>& before, HistoryStep step) {
    const Plan plan = plan_of(before, step);
    step.is_guided = plan.is_guided;
    step.by_chance = plan.by_chance;
    GatheredCloud<Model> gathered;
    GuidedStep<Model> guided{step.action, step.observation, numbers_, random_};
    guided.leave_to_chance(plan.by_chance);
    for (std::size_t i = 0; i < plan.trials.size(); ++i) {
      const double expected = plan.trials[i];
      if (expected < 1 && !random_.flag(expected)) continue;
      const long trials = std::max(1L, std::lround(expected));
      const auto& [state, weight] = before.particles[i];
      const double grown = expected < 1 ? weight / expected : weight;
      const Parent parent{state, grown, before.lineages[i].grown_squares(weight, grown), before.lineages[i].trace, trials};
      if (plan.is_guided) guide(parent, guided, gathered);
      else draw(parent, step, gathered);
    }
    update_effort.steps += guided.runs();
    step.guides_numbers = guided.meets_numbers();
    return gathered.updated(before, step, particle_count, random_);
  }

  struct Parent {
    const State& state;
    double weight;
    double squares;
    const TraceLink& trace;
    long trials;

    double weight_of_trial() const { return weight / trials; }
  };

  // Draws whole steps at random. One is enough if the step makes no draw.
  void draw(const Parent& parent, const HistoryStep& step, GatheredCloud<Model>& gathered) {
    for (long trial = 0; trial < parent.trials; ++trial) {
      State next = parent.state;
      Block block = free_block();
      ++update_effort.steps;
      const bool agrees = step.agrees(Model::step(next, step.action, replay_));
      block.draws = replay_.draws();
      block.likelihood = agrees ? replay_.weight() : 0;
      const bool is_certain = block.draws == 0;
      if (block.likelihood > 0) {
        const double weight = block.likelihood * (is_certain ? parent.weight : parent.weight_of_trial());
        const double squares = is_certain ? parent.squares * block.likelihood * block.likelihood : weight * weight;
        gathered.add(next, weight, squares, longer(parent.trace, std::move(block)), random_);
      }
      if (is_certain) return;
    }
  }

  // Guides steps towards the observation. One is enough if it followed all outcomes.
  void guide(const Parent& parent, GuidedStep<Model>& guided, GatheredCloud<Model>& gathered) {
    for (long trial = 0; trial < parent.trials; ++trial) {
      outcomes_.clear();
      const double sum = guided.from(parent.state, [&](const State& next, double weight, const List<double>& values) {
        outcomes_.push_back({next, weight, values});
      });
      const bool is_whole = guided.was_exhaustive();
      for (auto& [next, likelihood, values] : outcomes_) {
        const double weight = (is_whole ? parent.weight : parent.weight_of_trial()) * likelihood;
        const double squares = is_whole ? parent.squares * likelihood * likelihood : weight * weight;
        const std::uint32_t draws = values.size();
        gathered.add(next, weight, squares, longer(parent.trace, {std::move(values), 0, sum, draws}), random_);
      }
      if (is_whole) return;
    }
  }

  struct Outcome {
    State next;
    double likelihood;
    List<double> values;
  };

  Sampler& random_;
  Sampler chance_{0};
  Replay replay_;
  const List<double> none_;
  List<Outcome> outcomes_;
  NumberSink* numbers_ = nullptr;
};

}
