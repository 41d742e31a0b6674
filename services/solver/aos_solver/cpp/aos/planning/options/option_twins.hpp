// Which tests tell of nothing but the best option. Among few states each detail of a state tells it from all others, and so seems to
// tell which option is best there. So each state gets a twin: another state of the belief, with details of its own, in which the
// same option is best. A test that tells of options only reports the same from both. A state without one is its own twin if the mission
// ends by the best option, and the belief has others that differ from it only in what runs down, if at all: it has no details.
#pragma once

#include "aos/planning/options/option_gains.hpp"
#include "aos/planning/options/option_library.hpp"
#include "aos/planning/options/option_regret.hpp"
#include "aos/planning/options/option_search.hpp"
#include "aos/planning/options/sampled_belief.hpp"
#include "aos/planning/options/step_reports.hpp"

namespace aos {

template <class Model>
class OptionTwins {
 public:
  using State = typename Model::State;

  OptionTwins(const SampledBelief<Model>& sampled, const OptionRegret<Model>& regret, const OptionLibrary<Model>& library)
      : sampled_(sampled), regret_(regret), library_(library) {}

  void forget() { twins_.clear(); }
  // Whether at least half of the last belief has twins.
  bool are_known() const { return !twins_.empty(); }

  // Looks for twins where in each state one option is best, and none follows it. Where the mission ends by it, there may be states in
  // which nothing is earned. It takes at most so many steps of the model.
  void find(const Belief<Model>& belief, double most_steps, double& steps, Sampler& random) {
    forget();
    if (has_many_ways()) return;
    List<State> others;
    draw_evenly<Model>(belief.particles(), most_others, random, [&](const State& state) {
      if (Model::ending(state) == Ending::running) others.push_back(state);
    });
    if (others.empty()) return;
    double found = 0;
    for (std::size_t k = 0; k < sampled_.size(); ++k) {
      if (regret_.only_ways()[k] == OptionGains<Model>::none) continue;
      const double share = most_steps / sampled_.size();
      double left = share;
      const State* const twin = twin_of(k, others, left, random);
      steps -= share - left;
      if (twin == nullptr) continue;
      twins_.push_back({k, *twin});
      found += sampled_.weights()[k];
    }
    if (found < enough) forget();
  }

  // Whether a test tells of nothing but the best option: twins report the same. `reports` are by state.
  bool tells_of_options(int action, const List<StepReports>& reports, double& steps, Sampler& random) {
    StepReports there;
    return std::ranges::all_of(twins_, [&](const Twin& twin) {
      State state = twin.state;
      step_.take(state, action, there, steps, random);
      return there.is_like(reports[twin.of]);
    });
  }

 private:
  static constexpr std::size_t most_others = 1024;
  static constexpr double enough = 0.5;  // of the belief

  struct Twin {
    std::size_t of;  // the number of the state that it is a twin of
    State state;
  };

  // Whether in some state several options are best together, or none is while those of the others leave something to do.
  bool has_many_ways() const {
    bool is_end = true;
    bool has_none = false;
    for (std::size_t k = 0; k < sampled_.size(); ++k) {
      const bool is_none = regret_.only_ways()[k] == OptionGains<Model>::none;
      if (is_none && regret_.value_seen(k) > 0) return true;
      has_none = has_none || is_none;
      is_end = is_end && (is_none || regret_.ends(k));
    }
    return has_none && !is_end;
  }

  const State* twin_of(std::size_t k, const List<State>& others, double& left, Sampler& random) const {
    const State& own = sampled_.states()[k];
    const std::size_t first = random.below(static_cast<int>(others.size()));
    bool has_alike = false;
    for (std::size_t i = 0; i < others.size() && left > 0 && !library_.clock().is_over(); ++i) {
      const State& other = others[(first + i) % others.size()];
      if (!library_.running_down().differ(other, own)) has_alike = true;
      else if (earns_as_much(other, k, left, random)) return &other;
    }
    return has_alike && regret_.ends(k) ? &own : nullptr;
  }

  bool earns_as_much(const State& other, std::size_t k, double& left, Sampler& random) const {
    const Option& option = library_.options()[regret_.only_ways()[k]];
    State state = other;
    left -= static_cast<double>(option.size());
    return taken_option<Model>(option, state, random, library_.retries()).earned > regret_.value_seen(k) / 2;
  }

  const SampledBelief<Model>& sampled_;
  const OptionRegret<Model>& regret_;
  const OptionLibrary<Model>& library_;
  List<Twin> twins_;
  ReportedStep<Model> step_;
};

}
