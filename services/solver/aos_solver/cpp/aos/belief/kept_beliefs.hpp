// Beliefs that outlive a process, in a file that its parent holds open. Each change of what is believed has a
// number, which the parent gives: it counts the changes that it was told of. The file has room for the state after two changes: if
// a process ends during a change, the state before the change is whole.
#pragma once

#include "aos/base/descriptor_file.hpp"
#include "aos/belief/history.hpp"
#include "aos/belief/hypotheses.hpp"
#include "aos/belief/kept_traces.hpp"
#include "aos/belief/saved_history.hpp"

namespace aos {

template <class Model>
class KeptBeliefs {
 public:
  // A negative descriptor keeps nothing.
  explicit KeptBeliefs(int descriptor) : file_(descriptor), traces_(file_, 2 * area_bytes, area_bytes) {}

  // Gives the next change its number, which is one more than that of the change before.
  void number_next(std::uint64_t change) { change_ = change; }

  // Keeps what is believed after that change. A file without room for it keeps nothing.
  void keep(const Hypotheses<Model>& hypotheses) {
    if (!file_.is_open()) return;
    const auto beliefs = hypotheses.beliefs();
    const Words words = hypotheses.words();
    traces_.begin();
    for (const Belief<Model>* belief : beliefs) {
      for (const Lineage& lineage : belief->lineages()) traces_.keep(lineage.trace);
    }
    const bool has_traces = traces_.end();
    put_head({});
    file_.write(words.data(), words.size() * sizeof(Words::value_type));
    for (const Belief<Model>* belief : beliefs) put_belief(*belief);
    const bool is_whole = file_.flush() && has_traces && file_.place() - begin() <= area_bytes;
    if (is_whole) put_head({change_, beliefs.size(), words.size(), traces_.extent()});
    file_.flush();
  }

  // What was believed after this change, as it was; nothing if that was not kept.
  std::optional<Hypotheses<Model>> restore(std::uint64_t change) {
    change_ = change;
    Head head{};
    file_.seek(begin());
    file_.read(&head, sizeof head);
    if (!file_.is_good() || head.change != change || head.beliefs == 0) return std::nullopt;
    const List<TraceLink> traces = traces_.restore(head.traces);
    if (traces.size() != head.traces.blocks) return std::nullopt;
    file_.seek(begin() + static_cast<off_t>(sizeof head));
    const Words words = next_words(head.words);
    List<Belief<Model>> beliefs;
    while (file_.is_good() && beliefs.size() < head.beliefs) beliefs.push_back(next_belief(traces));
    if (!file_.is_good()) return std::nullopt;
    return Hypotheses<Model>::of(std::move(beliefs), words);
  }

 private:
  using Particle = aos::Particle<Model>;
  using Origins = typename History<Model>::Origins;

  struct Head {
    std::uint64_t change;
    std::uint64_t beliefs;
    std::uint64_t words;
    KeptTraces::Extent traces;
  };
  struct BeliefHead {
    std::uint64_t particles;
    std::uint64_t lineages;
    std::uint64_t steps;
    std::uint64_t step_words;
    std::uint64_t origins;
    double error_bound;
    std::uint32_t since_moves;
    std::uint32_t pause;
    bool is_drawn;
    bool has_all_origins;
  };
  struct KeptLineage {
    double squares;
    std::uint64_t trace;
  };
  static constexpr std::uint64_t no_trace = ~std::uint64_t{0};

  // The two places are far apart, and those of the traces come after them; the file takes memory only for what is written.
  // It is limited to four times this, as engine_child.py knows.
  static constexpr off_t area_bytes = off_t{1} << 31;
  off_t begin() const { return static_cast<off_t>(change_ % 2) * area_bytes; }

  // The seek writes what was put before, so that the file has the same order.
  void put_head(const Head& head) {
    file_.seek(begin());
    file_.write(&head, sizeof head);
  }
  void put_belief(const Belief<Model>& belief) {
    const auto& particles = belief.particles();
    const auto rest = belief.history().rest();
    const auto& steps = belief.history().steps();
    Words step_words;
    for (const HistoryStep& step : steps) detail::add_step(step_words, step);
    put_as_bytes(BeliefHead{.particles = particles.size(),
                            .lineages = belief.lineages().size(),
                            .steps = steps.size(),
                            .step_words = step_words.size(),
                            .origins = rest.origins ? rest.origins->states.size() : 0,
                            .error_bound = belief.error_bound(),
                            .since_moves = rest.since_moves,
                            .pause = rest.pause,
                            .is_drawn = belief.is_drawn(),
                            .has_all_origins = rest.has_all_origins});
    for (const auto& [state, weight] : particles) put_state(state, weight);
    for (const Lineage& lineage : belief.lineages()) {
      put_as_bytes(KeptLineage{lineage.squares, lineage.trace == nullptr ? no_trace : lineage.trace->kept.number});
    }
    file_.write(step_words.data(), step_words.size() * sizeof(Words::value_type));
    if (!rest.origins) return;
    for (std::size_t i = 0; i < rest.origins->states.size(); ++i) {
      put_state(rest.origins->states[i], rest.origins->cumulative[i]);
    }
  }
  Belief<Model> next_belief(const List<TraceLink>& traces) {
    BeliefHead head{};
    file_.read(&head, sizeof head);
    Cloud<Model> cloud;
    cloud.particles.resize(file_.is_good() ? head.particles : 0);
    for (auto& [state, weight] : cloud.particles) get_state(state, weight);
    for (std::uint64_t left = file_.is_good() ? head.lineages : 0; left > 0; --left) {
      KeptLineage lineage{};
      file_.read(&lineage, sizeof lineage);
      if (lineage.trace == no_trace) {
        cloud.lineages.push_back({lineage.squares, nullptr});
      } else if (lineage.trace < traces.size()) {
        cloud.lineages.push_back({lineage.squares, traces[lineage.trace]});
      }
    }
    cloud.history = next_history(head);
    return Belief<Model>::of(std::move(cloud), head.error_bound, head.is_drawn);
  }
  History<Model> next_history(const BeliefHead& head) {
    const Words words = next_words(head.step_words);
    detail::WordReader reader{words};
    List<HistoryStep> steps;
    for (std::uint64_t left = head.steps; left > 0 && reader.left() > 0; --left) {
      auto [step, text] = detail::next_step(reader);
      if (!text.empty()) step.observation = text_observation(text);
      steps.push_back(std::move(step));
    }
    std::shared_ptr<Origins> origins;
    if (file_.is_good() && head.origins > 0) {
      origins = std::make_shared<Origins>();
      origins->states.resize(head.origins);
      origins->cumulative.resize(head.origins);
      for (std::size_t i = 0; i < head.origins; ++i) get_state(origins->states[i], origins->cumulative[i]);
    }
    return {std::move(steps), {std::move(origins), head.has_all_origins, head.since_moves, head.pause}};
  }
  Words next_words(std::uint64_t count) {
    Words words(file_.is_good() ? count : 0);
    file_.read(words.data(), words.size() * sizeof(Words::value_type));
    return words;
  }
  void put_state(const typename Model::State& state, double weight) {
    put_as_bytes(weight);
    file_.write(Model::bytes_of(state), Model::state_bytes());
  }
  void get_state(typename Model::State& state, double& weight) {
    file_.read(&weight, sizeof weight);
    file_.read(Model::bytes_of(state), Model::state_bytes());
  }
  void put_as_bytes(const auto& value) { file_.write(&value, sizeof value); }

  DescriptorFile file_;
  KeptTraces traces_;
  std::uint64_t change_ = 0;
};

}
