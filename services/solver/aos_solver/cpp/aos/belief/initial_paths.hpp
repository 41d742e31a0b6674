// How many combinations of draws an initial belief has.
#pragma once

#include "aos/draws/loop_heads.hpp"
#include "aos/draws/replay.hpp"

namespace aos {

// An estimate of the combinations of draws in the initial belief: the median of estimates from single
// paths, each of which is right on average (Knuth, 1975). Of the rounds of a loop only the last counts, since an
// enumeration cuts paths there. Infinite if a draw is continuous.
template <class Model>
double estimated_initial_paths(Sampler& random) {
  struct Alternatives final : DrawWatcher, LoopHeads {
    double product = 1;
    List<double> before_loops;  // the product where each loop began
    void before_draw(std::size_t, const double* weights, int count, double) override {
      const auto positive = std::count_if(weights, weights + count, [](double weight) { return weight > 0; });
      product *= weights == nullptr ? std::numeric_limits<double>::infinity() : static_cast<double>(positive);
    }
    std::uint32_t enter() override {
      before_loops.push_back(product);
      return static_cast<std::uint32_t>(before_loops.size() - 1);
    }
    std::string* arrive(std::uint32_t, std::uint32_t entry) override {
      if (std::isfinite(product)) product = before_loops[entry];
      return nullptr;
    }
    [[noreturn]] void cut() override { throw CutPath{}; }
  };
  List<double> estimates;
  const List<double> none;
  Replay replay;
  typename Model::State state{};
  for (int i = 0; i < 11; ++i) {
    Alternatives alternatives;
    replay.start(none, random, nullptr, &alternatives, &alternatives);
    Model::initial(state, replay);
    estimates.push_back(alternatives.product);
  }
  std::nth_element(estimates.begin(), estimates.begin() + 5, estimates.end());
  return estimates[5];
}

}
