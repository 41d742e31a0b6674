// Resample-move (Gilks and Berzuini, 2001). Particles that have become few, or that descend from few origins,
// are copied. Each copy is moved by the Metropolis-Hastings rule, which leaves the belief as it is.
//
// A proposal changes some draws of one block of a particle's trace, the origin's or a step's: numbers in [0, 1) that are uniform
// and independent under the documents (primary sample space: Kelemen and others, 2002). The rest is replayed, and the later
// steps decide. One that was drawn freely must give what was observed then. A guided one is guided anew from its new state, and
// its likelihood counts (pseudo-marginal: Andrieu and Roberts, 2009).
//
// Another kind of proposal makes many draws of the origin anew on which no observation seems to depend (free_draws.hpp). All later
// steps are replayed with their own draws. A guided one keeps its estimated likelihood and has to draw from the same weights as
// before. What a continuous draw leads to may differ though its numbers are the same: such a step is guided anew.
//
// The states that a copy has passed are kept (passage.hpp). The limits of `moved` count the steps of a proposal that repeats all.
#pragma once

#include "aos/belief/free_draws.hpp"
#include "aos/belief/guided_step.hpp"
#include "aos/belief/history.hpp"
#include "aos/belief/passage.hpp"
#include "aos/draws/replay.hpp"

namespace aos {

inline constexpr std::size_t max_passage_bytes = std::size_t{64} << 20;  // of all copies of a call
inline constexpr std::size_t max_moving_steps = 600'000;  // of one call with an effort of 1
inline constexpr std::size_t min_copies = 500;
inline constexpr std::size_t max_copies = 5000;
inline constexpr int proposals_in_a_row = 4;                // of one copy
inline constexpr std::size_t telling_share = 10;         // the part of the steps after which moves may end early
inline constexpr double few_moves = 0.15;                // accepted ones for each copy, by all steps; with fewer in sight moves end

template <class Model>
class Moves {
 public:
  using State = typename Model::State;

  // Where all that the copies have passed takes more than `passage_bytes`, none of it is kept.
  Moves(const History<Model>& history, Sampler& random, std::size_t passage_bytes = max_passage_bytes)
      : history_(history), random_(random), passage_bytes_(passage_bytes) {}

  // Copies of a cloud's particles after moves, or the cloud as it is if no move succeeds. A longer history
  // has fewer copies, so that each copy has enough moves. A greater effort has more copies and more moves.
  Cloud<Model> moved(const Cloud<Model>& cloud, std::size_t effort = 1) {
    const std::size_t max_steps = effort * max_moving_steps;
    const std::size_t copies = std::clamp(max_steps / (20 * (1 + cloud.history.steps().size())), min_copies, max_copies);
    copy(cloud, copies);
    const std::size_t bytes = sizeof(State) + Model::bytes_elsewhere() + sizeof(typename Passage<Model>::Place);
    are_kept_ = copies_.size() * (1 + history_.steps().size()) * bytes <= passage_bytes_;
    passages_.resize(are_kept_ ? copies_.size() : 1);
    std::size_t accepted = 0;
    while (work_ < max_steps && !is_hopeless(accepted, max_steps)) {
      for (std::size_t i = 0; i < copies_.size() && work_ < max_steps && !is_hopeless(accepted, max_steps); ++i) {
        Copy& copy = copies_[i];
        Passage<Model>& passage = passages_[are_kept_ ? i : 0];
        if (!are_kept_ || passage.empty()) passage.begin(copy.trace);
        if (i + 1 < passages_.size()) passages_[i + 1].prefetch();
        // Several in a row, while all that the copy has passed is in the processor's cache.
        for (int proposal = 0; proposal < proposals_in_a_row && work_ < max_steps; ++proposal) {
          if (!(random_.flag(free_draws_.share()) ? refresh(copy, passage) : move(copy, passage))) continue;
          ++accepted;
          copy.is_moved = true;
        }
        if (!are_kept_ && copy.is_moved) copy.trace = passage.trace(copy.trace);
      }
    }
    return accepted > 0 ? gathered(cloud, copies_.size()) : cloud;
  }

  std::size_t copies() const { return copies_.size(); }
  std::size_t steps() const { return steps_; }

 private:
  struct Copy {
    std::size_t particle;
    State state;
    double weight;
    TraceLink trace;
    bool is_moved;
  };

  bool is_hopeless(std::size_t accepted, std::size_t max_steps) const {
    const double share = static_cast<double>(work_) / static_cast<double>(max_steps);
    return share * telling_share >= 1 && static_cast<double>(accepted) < few_moves * share * static_cast<double>(copies_.size());
  }

  // Makes copies in proportion to the weights. Each particle has at least one unless there are too many particles.
  void copy(const Cloud<Model>& cloud, std::size_t copies) {
    const double unit = cloud.total() / copies;
    List<double> weights;
    for (const auto& particle : cloud.particles) weights.push_back(particle.weight);
    thin_out(weights, copies, random_);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] <= 0) continue;
      const auto& state = cloud.particles[i].state;
      const double weight = weights[i];
      const long count = std::max(1L, std::lround(weight / unit));
      for (long copy = 0; copy < count; ++copy) {
        copies_.push_back({i, state, weight / count, cloud.lineages[i].trace, false});
      }
    }
    // Moves may end before all copies had their turn. In the particles' order those would be copies of the first states.
    for (std::size_t i = copies_.size(); i > 1; --i) std::swap(copies_[i - 1], copies_[random_.below(static_cast<int>(i))]);
  }

  // Merges the copies. Those that were not moved are worth as many samples as their particle was.
  Cloud<Model> gathered(const Cloud<Model>& cloud, std::size_t max_particles) {
    for (std::size_t i = 0; i < copies_.size(); ++i) {
      if (are_kept_ && copies_[i].is_moved) copies_[i].trace = passages_[i].trace(copies_[i].trace);
    }
    List<double> unmoved(cloud.particles.size(), 0);
    for (const Copy& copy : copies_) unmoved[copy.particle] += copy.is_moved ? 0 : copy.weight;
    GatheredCloud<Model> gathered;
    for (std::size_t i = 0; i < unmoved.size(); ++i) {
      if (unmoved[i] == 0) continue;
      const auto& [state, weight] = cloud.particles[i];
      const double squares = unmoved[i] < weight ? cloud.lineages[i].squares * std::pow(unmoved[i] / weight, 2)
                                                 : cloud.lineages[i].grown_squares(weight, unmoved[i]);
      gathered.add(state, unmoved[i], squares, cloud.lineages[i].trace, random_);
    }
    for (Copy& copy : copies_) {
      if (copy.is_moved) gathered.add(copy.state, copy.weight, copy.weight * copy.weight, std::move(copy.trace), random_);
    }
    return gathered.thinned(max_particles, cloud.history, random_);
  }

  // Makes one proposal, at one of all draws of the trace. A change that leads to the same state is no move.
  bool move(Copy& copy, Passage<Model>& passage) {
    const auto [place, first] = random_draw(passage);
    work_ += 1;
    const std::size_t count = passage.size();
    if (place == count) return false;
    work_ += place;
    State state{};
    if (place > 0) state = passed(passage, place - 1);
    proposed_.clear();
    states_.clear();
    double ratio = is_guided(place) ? guided(place, passage.block(place), state)
                                    : changed(place, first, passage.block(place), state);
    if (ratio <= 0) return false;
    work_ += 1;
    if (state == passed(passage, place)) return false;
    states_.push_back(state);
    for (std::size_t i = place + 1; i < count; ++i) {
      const Block& block = passage.block(i);
      if (is_guided(i)) {
        ratio *= guided(i, block, state);
      } else {
        work_ += 1;
        const double likelihood = repeat(i, block, state);
        proposed_.push_back({{}, block.seed, likelihood, static_cast<std::uint32_t>(replay_.draws())});
        ratio *= likelihood / block.likelihood;
      }
      if (ratio <= 0) return false;
      states_.push_back(state);
    }
    ratio *= way_back(passage, place);
    if (ratio < 1 && !random_.flag(ratio)) return false;
    copy.state = state;
    if (!is_guided(place)) proposed_.front().values = used_;
    for (std::size_t i = place + 1; i < count; ++i) {
      if (!is_guided(i)) proposed_[i - place].values = passage.block(i).values;
    }
    passage.replace(place, proposed_, states_);
    return true;
  }

  // Makes one proposal, of many draws of the origin made anew at once.
  bool refresh(Copy& copy, Passage<Model>& passage) {
    const Block& origin = passage.block(0);
    if (origin.draws == 0) return false;
    const List<std::size_t>& anew = free_draws_.choose(origin.draws, random_);
    list_values(origin, values_);
    for (const std::size_t draw : anew) {
      if (draw < values_.size()) values_[draw] = random_.uniform();
    }
    used_.clear();
    State after{};
    run(0, values_, random_, after, &used_);
    work_ += 2;
    if (after == passed(passage, 0)) return false;
    states_.assign(1, after);
    likelihoods_.clear();
    proposed_.clear();
    const bool is_accepted = still_brings(passage, after);
    free_draws_.note(is_accepted);
    if (!is_accepted) return false;
    copy.state = after;
    passage.refresh({used_, 0, 1, static_cast<std::uint32_t>(used_.size())}, states_, likelihoods_);
    std::size_t guided_anew = 0;
    for (std::size_t i = 1; i < passage.size(); ++i) {
      if (history_.steps()[i - 1].guides_numbers) passage.replace(i, std::move(proposed_[guided_anew++]));
    }
    return true;
  }

  // Runs all steps from another origin, to its last state. Returns whether that origin is accepted in place of the first.
  // It has to give what was observed, and the densities of the numbers decide by chance.
  bool still_brings(Passage<Model>& passage, State& after) {
    double ratio = 1;
    for (std::size_t i = 1; i < passage.size(); ++i) {
      if (history_.steps()[i - 1].guides_numbers) {
        ratio *= guided(i, passage.block(i), after);
        if (ratio <= 0) return false;
        states_.push_back(after);
        likelihoods_.push_back(proposed_.back().likelihood);
        continue;
      }
      const bool is_watched = is_guided(i);
      const auto& before = repeated(passage, i);
      work_ += 2;
      const double likelihood_after = repeat(i, passage.block(i), after, is_watched ? &weights_drawn_from_ : nullptr);
      if (is_watched && weights_drawn_from_.digest() != before.digest) return false;
      if (likelihood_after <= 0) return false;
      ratio *= likelihood_after / before.likelihood;
      states_.push_back(after);
      likelihoods_.push_back(likelihood_after);
    }
    return ratio >= 1 || random_.flag(ratio);
  }

  // The state after a block.
  const State& passed(Passage<Model>& passage, std::size_t place) {
    while (passage.passed() <= place) pass(passage, passage.passed());
    return passage.state(place);
  }
  // What came of a block when it was repeated as it is.
  const typename Passage<Model>::Repeated& repeated(Passage<Model>& passage, std::size_t place) {
    passed(passage, place - 1);
    if (!passage.is_repeated(place)) pass(passage, place);
    return passage.repeated(place);
  }
  void pass(Passage<Model>& passage, std::size_t place) {
    State state{};
    if (place > 0) state = passage.state(place - 1);
    const double likelihood = repeat(place, passage.block(place), state, is_guided(place) ? &weights_drawn_from_ : nullptr);
    passage.note(place, state, {likelihood, weights_drawn_from_.digest()});
  }

  static void list_values(const Block& block, List<double>& values) {
    values.assign(block.values.begin(), block.values.begin() + std::min<std::ptrdiff_t>(std::ssize(block.values), block.draws));
    for (Sampler later{block.seed}; values.size() < block.draws;) values.push_back(later.uniform());
  }

  struct DrawPlace {
    std::size_t block;
    std::size_t draw;
  };
  // One draw of all, at random. The block is the one after the last if there are no draws.
  DrawPlace random_draw(const Passage<Model>& passage) {
    if (passage.draws() == 0) return {passage.size(), 0};
    std::size_t left = random_.below(passage.draws());
    std::size_t place = 0;
    while (left >= passage.draws_of(place)) left -= passage.draws_of(place++);
    return {place, left};
  }
  // How much likelier the same place is to be chosen from the proposed trace than from this one. The place is
  // the same draw, or any draw of a guided block.
  double way_back(const Passage<Model>& passage, std::size_t place) const {
    const auto before = static_cast<double>(passage.draws());
    double after = 0;
    for (std::size_t i = 0; i < passage.size(); ++i) after += i < place ? passage.draws_of(i) : proposed_[i - place].draws;
    const double shares = is_guided(place) ? static_cast<double>(proposed_.front().draws) / passage.draws_of(place) : 1;
    return after > 0 ? shares * before / after : 0;
  }

  bool is_guided(std::size_t place) const { return place > 0 && history_.steps()[place - 1].is_guided; }

  // Runs a block's draws. Returns the density of the numbers, or 0 if the step does not give what was observed.
  double repeat(std::size_t place, const Block& block, State& state, DrawWatcher* watcher = nullptr) {
    Sampler later{block.seed};
    return run(place, block.values, later, state, nullptr, watcher);
  }
  double run(std::size_t place, const List<double>& values, Sampler& later, State& state,
           List<double>* record, DrawWatcher* watcher = nullptr) {
    ++steps_;
    if (place == 0) {
      replay_.start(values, later, record);
      history_.originate(state, replay_);
      return 1;
    }
    const HistoryStep& step = history_.steps()[place - 1];
    const NumbersOf numbers{step, replay_};
    weights_drawn_from_.start();
    replay_.start(values, later, record, watcher);
    return step.agrees(Model::step(state, step.action, replay_)) ? replay_.weight() : 0;
  }

  // Proposes a block with some draws changed from `first` on. Returns the factor of the acceptance ratio, which is 0 if the
  // proposal does not give what was observed.
  double changed(std::size_t place, std::size_t first, const Block& block, State& state) {
    work_ += 2;
    list_values(block, values_);
    perturb(values_, first);
    used_.clear();
    const double likelihood = run(place, values_, random_, state, &used_);
    proposed_.push_back({{}, 0, likelihood, static_cast<std::uint32_t>(used_.size())});
    return likelihood / block.likelihood;
  }

  // Draws a few values in a row anew, or turns them by a little. Both are as likely on the way back.
  void perturb(List<double>& values, std::size_t first) {
    const std::size_t length = random_.flag(0.5) ? 1 : random_.flag(0.05) ? values.size() : 2 + random_.below(3);
    const bool is_turned = random_.flag(0.3);
    const double reach = is_turned ? std::exp(std::log(0.5) - random_.uniform() * std::log(500.0)) : 0;
    for (std::size_t i = first; i < std::min(values.size(), first + length); ++i) {
      if (is_turned) {
        const double turned = values[i] + reach * (2 * random_.uniform() - 1);
        values[i] = turned - std::floor(turned);
        if (values[i] >= 1) values[i] = 0;
      } else {
        values[i] = random_.uniform();
      }
    }
  }

  // Proposes a step that is guided anew. Returns the factor of the acceptance ratio.
  double guided(std::size_t place, const Block& block, State& state) {
    const HistoryStep& step = history_.steps()[place - 1];
    NumbersOf numbers{step, replay_};
    GuidedStep<Model>& steps = guided_step(place);
    steps.report_to(numbers.sink());
    const std::size_t runs_before = steps.runs();
    const State before = state;
    double sum = 0;
    Block chosen;
    steps.from(before, [&](const State& next, double weight, const List<double>& values) {
      sum += weight;
      if (!random_.flag(weight / sum)) return;
      state = next;
      chosen.values = values;
    });
    work_ += steps.runs() - runs_before;
    steps_ += steps.runs() - runs_before;
    chosen.likelihood = sum;
    chosen.draws = chosen.values.size();
    proposed_.push_back(std::move(chosen));
    return sum / block.likelihood;
  }

  // What guides a step of the history; its memory serves all proposals.
  GuidedStep<Model>& guided_step(std::size_t place) {
    if (guided_steps_.size() <= place) guided_steps_.resize(place + 1);
    auto& guided = guided_steps_[place];
    if (guided == nullptr) {
      const HistoryStep& step = history_.steps()[place - 1];
      guided = std::make_unique<GuidedStep<Model>>(step.action, step.observation, nullptr, random_);
      guided->leave_to_chance(step.by_chance);
    }
    return *guided;
  }

  // A digest of the weights that a step draws from, to compare two steps.
  class Weights final : public DrawWatcher {
   public:
    void start() { digest_ = 0; }
    std::uint64_t digest() const { return digest_; }
    void before_draw(std::size_t, const double* weights, int count, double total) override {
      mix(count);
      for (int i = 0; i < count; ++i) mix(std::bit_cast<std::uint64_t>(weights[i] / total));
    }

   private:
    void mix(std::uint64_t bits) { digest_ = (std::rotl(digest_, 5) ^ bits) * 0x9e3779b97f4a7c15u; }
    std::uint64_t digest_ = 0;
  };

  const History<Model>& history_;
  Sampler& random_;
  std::size_t passage_bytes_;
  Replay replay_;
  Weights weights_drawn_from_;
  FreeDraws free_draws_;
  List<std::unique_ptr<GuidedStep<Model>>> guided_steps_;  // of the history's steps, from 1
  List<Copy> copies_;
  List<Passage<Model>> passages_;  // of the copies, or of one
  bool are_kept_ = false;
  List<State> states_;  // after the blocks of a proposal
  List<double> likelihoods_;
  List<double> values_;
  List<double> used_;     // by the block that is changed
  List<Block> proposed_;  // from that block on
  std::size_t work_ = 0;
  std::size_t steps_ = 0;
};

}
