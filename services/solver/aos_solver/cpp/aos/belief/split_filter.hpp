// The update of a belief whose steps have too many outcomes to list, by draws that split (split_draws.hpp): paths of heavy states
// are enumerated, those of light ones are drawn, equal states are merged, and the lightest are thinned out (Fearnhead and
// Clifford, 2003). Nothing is moved: where an observation leaves too few, particle_filter.hpp takes over. All limits are numbers
// of draws and paths, so that the same seed gives the same belief.
#pragma once

#include "aos/belief/effort.hpp"
#include "aos/belief/gathering.hpp"
#include "aos/belief/history.hpp"
#include "aos/draws/split_draws.hpp"

namespace aos {

inline constexpr double split_paths = 200'000;             // of one update, about
inline constexpr std::size_t max_split_work = 4'000'000;  // in draws; after as many, less is split

template <class Model>
class SplitFilter {
 public:
  using State = typename Model::State;

  // A belief has at most `limit` states. Lineages have no traces.
  SplitFilter(std::size_t limit, Sampler& random) : limit_(limit), random_(random), draws_(random) {}

  // The belief after a step. Throws NotEnumerable for a continuous draw.
  UpdatedCloud<Model> after(const Cloud<Model>& before, const HistoryStep& step, NumberSink& numbers) {
    draws_.report_to(&numbers);
    GatheredCloud<Model> gathered;
    double threshold = before.total() / split_paths;
    std::size_t work = 0;
    std::size_t most_work = max_split_work;
    for (std::size_t i = 0; i < before.particles.size(); ++i) {
      const auto& [state, weight] = before.particles[i];
      const double squares = before.lineages[i].squares / weight / weight;
      draws_.start(weight, threshold);
      do {
        State next = state;
        ++update_effort.steps;
        const Step done = Model::step(next, step.action, draws_);
        work += work_of_step(draws_, Model::state_bytes());
        if (draws_.weight() <= 0 || !step.agrees(done)) continue;
        add(gathered, next, draws_.weight(), squares_after(squares));
      } while (draws_.advance());
      if (work > most_work) {
        threshold *= 4;
        most_work += max_split_work / 4;
      }
    }
    return gathered.updated(before, step, affordable(before.particles.size(), work), random_);
  }

 private:
  // How many states the next update can afford, if they are as much work as these.
  std::size_t affordable(std::size_t states, std::size_t work) const {
    const double share = 2.0 * max_split_work / work;
    const auto count = static_cast<std::size_t>(share * static_cast<double>(states));
    return std::clamp(count, std::min(particle_count, limit_), limit_);
  }
  // Squares are relative to that of the weight: what is drawn is worth one sample.
  double squares_after(double before) const { return draws_.is_certain() ? before : 1; }
  void add(GatheredCloud<Model>& gathered, const State& state, double weight, double squares) {
    gathered.add(state, weight, weight * weight * squares, nullptr, random_);
    if (gathered.size() > 2 * limit_) gathered.reduce(limit_, random_);
  }

  std::size_t limit_;
  Sampler& random_;
  SplitDraws draws_;
};

}
