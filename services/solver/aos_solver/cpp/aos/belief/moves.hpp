// Resample-move (Gilks and Berzuini, 2001). Particles that have become few, or that descend from few origins,
// are copied. Each copy is moved by the Metropolis-Hastings rule, which leaves the belief as it is.
//
// A move changes the trace of a particle: all draws from the origin on, as numbers in [0, 1) that are uniform
// and independent under the documents (primary sample space: Kelemen and others, 2002). A proposal changes
// some draws of one block, the origin's or a step's. The rest is replayed, and the later steps decide on the
// proposal. A step that was drawn freely must give what was observed then. A guided step is guided anew from
// its new state, and its likelihood counts (pseudo-marginal: Andrieu and Roberts, 2009). So variables of two
// particles are never mixed, and what all histories have in common stays.
//
// Another kind of proposal makes many draws of the origin anew on which no observation seems to depend
// (free_draws.hpp). All later steps are replayed with their own draws, guided ones too, which costs one run a
// step. A guided step keeps its estimated likelihood. It has to draw from the same weights as before, so that
// other draws would have been guided alike. The parameters of continuous draws are not compared: there the
// kept likelihood is an approximation.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "aos/base/random.hpp"
#include "aos/base/replay.hpp"
#include "aos/belief/free_draws.hpp"
#include "aos/belief/guided_step.hpp"
#include "aos/belief/history.hpp"

namespace aos {

inline constexpr std::size_t max_moving_steps = 600'000;  // of one call with an effort of 1
inline constexpr std::size_t min_copies = 500;
inline constexpr std::size_t max_copies = 5000;
inline constexpr std::size_t telling_share = 10;         // if no proposal is accepted in a tenth of the steps, moves end

template <class Model>
class Moves {
 public:
  using State = typename Model::State;

  Moves(const History<Model>& history, Sampler& random) : history_(history), random_(random) {}

  // Copies of a cloud's particles after moves, or the cloud as it is if no move succeeds. A longer history
  // has fewer copies, so that each copy has enough moves. A greater effort has more copies and more moves.
  Cloud<Model> moved(const Cloud<Model>& cloud, std::size_t effort = 1) {
    const std::size_t max_steps = effort * max_moving_steps;
    const std::size_t copies = std::clamp(max_steps / (20 * (1 + cloud.history.steps().size())), min_copies, max_copies);
    copy(cloud, copies);
    std::size_t accepted = 0;
    while (steps_ < max_steps) {
      for (Copy& copy : copies_) {
        accepted += (random_.flag(free_draws_.share()) ? refresh(copy) : move(copy)) ? 1 : 0;
        if (accepted == 0 && steps_ >= max_steps / telling_share) return cloud;
        if (steps_ >= max_steps) break;
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

  // Makes copies in proportion to the weights. Each particle has at least one unless there are too many particles.
  void copy(const Cloud<Model>& cloud, std::size_t copies) {
    const double unit = cloud.total() / static_cast<double>(copies);
    std::vector<double> weights;
    for (const auto& particle : cloud.particles) weights.push_back(particle.weight);
    thin_out(weights, copies, random_);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] <= 0) continue;
      const auto& state = cloud.particles[i].state;
      const double weight = weights[i];
      const long count = std::max(1L, std::lround(weight / unit));
      for (long copy = 0; copy < count; ++copy) {
        copies_.push_back({i, state, weight / static_cast<double>(count), cloud.lineages[i].trace, false});
      }
    }
  }

  // Merges the copies. Those that were not moved are worth as many samples as their particle was.
  Cloud<Model> gathered(const Cloud<Model>& cloud, std::size_t max_particles) {
    std::vector<double> unmoved(cloud.particles.size(), 0);
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
  bool move(Copy& copy) {
    list_blocks(copy.trace, blocks_);
    const std::vector<const Block*>& blocks = blocks_;
    const auto [place, first] = random_draw(blocks);
    ++steps_;
    if (place == blocks.size()) return false;
    State state{};
    for (std::size_t i = 0; i < place; ++i) repeat(i, *blocks[i], state);
    State before = state;
    std::vector<Block> proposed;
    proposed.reserve(blocks.size() - place);
    double ratio = is_guided(place) ? guided(place, *blocks[place], state, proposed)
                                    : changed(place, first, *blocks[place], state, before, proposed);
    if (ratio <= 0) return false;
    if (is_guided(place)) {
      repeat(place, *blocks[place], before);
    } else {
      ++steps_;  // `changed` has made it.
    }
    if (state == before) return false;
    for (std::size_t i = place + 1; i < blocks.size(); ++i) {
      if (is_guided(i)) {
        ratio *= guided(i, *blocks[i], state, proposed);
      } else {
        const double likelihood = repeat(i, *blocks[i], state);
        proposed.push_back({{}, blocks[i]->seed, likelihood, static_cast<std::uint32_t>(replay_.draws())});
        ratio *= likelihood / blocks[i]->likelihood;
      }
      if (ratio <= 0) return false;
    }
    ratio *= way_back(blocks, proposed, place);
    if (ratio < 1 && !random_.flag(ratio)) return false;
    copy.state = state;
    for (std::size_t i = place + 1; i < blocks.size(); ++i) {
      if (!is_guided(i)) proposed[i - place].values = blocks[i]->values;
    }
    copy.trace = replaced(copy.trace, blocks.size() - place, proposed);
    copy.is_moved = true;
    return true;
  }

  // Makes one proposal, of many draws of the origin made anew at once.
  bool refresh(Copy& copy) {
    list_blocks(copy.trace, blocks_);
    const std::vector<const Block*>& blocks = blocks_;
    if (blocks[0]->draws == 0) return false;
    const std::vector<std::size_t>& anew = free_draws_.choose(blocks[0]->draws, random_);
    std::vector<double>& values = values_;
    values.clear();
    State before{};
    Sampler later{blocks[0]->seed};
    run(0, blocks[0]->values, later, before, &values);
    for (const std::size_t draw : anew) {
      if (draw < values.size()) values[draw] = random_.uniform();
    }
    std::vector<double> used;
    State after{};
    run(0, values, random_, after, &used);
    if (after == before) return false;
    const bool is_accepted = still_brings(blocks, before, after);
    free_draws_.note(is_accepted);
    if (!is_accepted) return false;
    std::vector<Block> proposed;
    const auto draws = static_cast<std::uint32_t>(used.size());
    proposed.push_back({std::move(used), 0, 1, draws});
    for (std::size_t i = 1; i < blocks.size(); ++i) proposed.push_back(*blocks[i]);
    copy.state = after;
    copy.trace = replaced(copy.trace, blocks.size(), proposed);
    copy.is_moved = true;
    return true;
  }

  // Runs all steps from either origin, to their last states. Returns whether the second origin is accepted in
  // place of the first. It has to give what was observed, and the densities of the numbers decide by chance.
  bool still_brings(const std::vector<const Block*>& blocks, State& before, State& after) {
    double ratio = 1;
    for (std::size_t i = 1; i < blocks.size(); ++i) {
      DrawWatcher* const watcher = is_guided(i) ? &weights_drawn_from_ : nullptr;
      const double likelihood_before = repeat(i, *blocks[i], before, watcher);
      const std::uint64_t weights_before = weights_drawn_from_.digest();
      const double likelihood_after = repeat(i, *blocks[i], after, watcher);
      if (is_guided(i) && weights_drawn_from_.digest() != weights_before) return false;
      if (likelihood_after <= 0) return false;
      ratio *= likelihood_after / likelihood_before;
    }
    return ratio >= 1 || random_.flag(ratio);
  }

  struct DrawPlace {
    std::size_t block;
    std::size_t draw;
  };
  // One draw of all, at random. The block is the one after the last if there are no draws.
  DrawPlace random_draw(const std::vector<const Block*>& blocks) {
    std::size_t left = 0;
    for (const Block* block : blocks) left += block->draws;
    if (left == 0) return {blocks.size(), 0};
    left = static_cast<std::size_t>(random_.below(static_cast<int>(left)));
    std::size_t place = 0;
    while (left >= blocks[place]->draws) left -= blocks[place++]->draws;
    return {place, left};
  }
  // How much likelier the same place is to be chosen from the proposed trace than from this one. The place is
  // the same draw, or any draw of a guided block.
  double way_back(const std::vector<const Block*>& blocks, const std::vector<Block>& proposed, std::size_t place) const {
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      before += blocks[i]->draws;
      after += i < place ? blocks[i]->draws : proposed[i - place].draws;
    }
    const double shares = is_guided(place) ? static_cast<double>(proposed[0].draws) / blocks[place]->draws : 1;
    return after > 0 ? shares * before / after : 0;
  }

  bool is_guided(std::size_t place) const { return place > 0 && history_.steps()[place - 1].is_guided; }

  // Runs a block's draws. Returns the density of the numbers, or 0 if the step does not give what was observed.
  double repeat(std::size_t place, const Block& block, State& state, DrawWatcher* watcher = nullptr) {
    Sampler later{block.seed};
    return run(place, block.values, later, state, nullptr, watcher);
  }
  double run(std::size_t place, const std::vector<double>& values, Sampler& later, State& state,
           std::vector<double>* record, DrawWatcher* watcher = nullptr) {
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
    return step.agrees(History<Model>::run(state, step, replay_)) ? replay_.weight() : 0;
  }

  // Proposes a block with some draws changed from `first` on, and makes `old` the state that the block gives. Returns the
  // factor of the acceptance ratio, which is 0 if the proposal does not give what was observed.
  double changed(std::size_t place, std::size_t first, const Block& block, State& state, State& old,
                 std::vector<Block>& proposed) {
    std::vector<double>& values = values_;
    values.clear();
    Sampler later{block.seed};
    run(place, block.values, later, old, &values);
    perturb(values, first);
    std::vector<double> used;
    used.reserve(values.size());
    const double likelihood = run(place, values, random_, state, &used);
    const auto draws = static_cast<std::uint32_t>(used.size());
    proposed.push_back({std::move(used), 0, likelihood, draws});
    return likelihood / block.likelihood;
  }

  // Draws a few values in a row anew, or turns them by a little. Both are as likely on the way back.
  void perturb(std::vector<double>& values, std::size_t first) {
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
  double guided(std::size_t place, const Block& block, State& state, std::vector<Block>& proposed) {
    const HistoryStep& step = history_.steps()[place - 1];
    NumbersOf numbers{step, replay_};
    GuidedStep<Model> steps{step.action, step.observation, numbers.sink(), random_};
    steps.leave_to_chance(step.by_chance);
    const State before = state;
    double sum = 0;
    Block chosen;
    steps.from(before, [&](const State& next, double weight, const std::vector<double>& values) {
      sum += weight;
      if (!random_.flag(weight / sum)) return;
      state = next;
      chosen.values = values;
    });
    steps_ += steps.runs();
    chosen.likelihood = sum;
    chosen.draws = static_cast<std::uint32_t>(chosen.values.size());
    proposed.push_back(std::move(chosen));
    return sum / block.likelihood;
  }

  // A trace with its last `count` blocks replaced.
  static TraceLink replaced(TraceLink trace, std::size_t count, std::vector<Block>& blocks) {
    for (std::size_t i = 0; i < count; ++i) trace = trace->before;
    for (Block& block : blocks) {
      trace = trace == nullptr ? begun_trace(std::move(block)) : longer(std::move(trace), std::move(block));
    }
    return trace;
  }

  // A digest of the weights that a step draws from, to compare two steps.
  class Weights final : public DrawWatcher {
   public:
    void start() { digest_ = 0; }
    std::uint64_t digest() const { return digest_; }
    void before_draw(std::size_t, const double* weights, int count, double total) override {
      mix(static_cast<std::uint64_t>(count));
      for (int i = 0; i < count; ++i) mix(std::bit_cast<std::uint64_t>(weights[i] / total));
    }

   private:
    void mix(std::uint64_t bits) { digest_ = (std::rotl(digest_, 5) ^ bits) * 0x9e3779b97f4a7c15u; }
    std::uint64_t digest_ = 0;
  };

  const History<Model>& history_;
  Sampler& random_;
  Replay replay_;
  Weights weights_drawn_from_;
  FreeDraws free_draws_;
  std::vector<Copy> copies_;
  std::vector<const Block*> blocks_;  // of the trace that is moved
  std::vector<double> values_;
  std::size_t steps_ = 0;
};

}  // namespace aos
