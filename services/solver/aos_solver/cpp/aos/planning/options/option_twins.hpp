// Which tests tell of nothing but the best option. Among few states each detail of a state tells it from all others, and so seems to
// tell which option is best there. So each state gets a twin: another state of the belief, with details of its own, in which the
// same option is best. A test that tells of options only reports the same from both.
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

  // Looks for twins where in each state one option is best, and none follows it. It takes at most so many steps of the model.
  void find(const Belief<Model>& belief, double most_steps, double& steps, Sampler& random) {
    forget();
    if (std::ranges::count(regret_.only_ways(), OptionGains<Model>::none) > 0) return;
    List<State> others;
    draw_evenly<Model>(belief.particles(), most_others, random, [&](const State& state) {
      if (Model::ending(state) == Ending::running) others.push_back(state);
    });
    if (others.empty()) return;
    double left = most_steps;
    double found = 0;
    for (std::size_t k = 0; k < sampled_.size(); ++k) {
      const std::size_t first = random.below(static_cast<int>(others.size()));
      for (std::size_t i = 0; i < others.size() && left > 0 && !library_.clock().is_over(); ++i) {
        const State& other = others[(first + i) % others.size()];
        if (!is_twin(other, k, left, random)) continue;
        twins_.push_back({k, other});
        found += sampled_.weights()[k];
        break;
      }
    }
    steps -= most_steps - left;
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

  bool is_twin(const State& other, std::size_t k, double& left, Sampler& random) const {
    const Option& option = library_.options()[regret_.only_ways()[k]];
    State state = other;
    left -= static_cast<double>(option.size());
    const double earned = taken_option<Model>(option, state, random, library_.retries()).earned;
    return earned > regret_.value_seen(k) / 2 && library_.running_down().differ(other, sampled_.states()[k]);
  }

  const SampledBelief<Model>& sampled_;
  const OptionRegret<Model>& regret_;
  const OptionLibrary<Model>& library_;
  List<Twin> twins_;
  ReportedStep<Model> step_;
};

}
