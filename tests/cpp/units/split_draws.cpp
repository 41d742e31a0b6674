// Draws that split heavy paths and sample light ones: split_draws.hpp.
#include "aos/draws/split_draws.hpp"

#include "aos/model/support.hpp"
#include "check.hpp"

namespace units::split_draws_tests {

using namespace aos;

// Calls `visit()` at the end of each path.
void walk(SplitDraws& draws, double weight, double threshold, auto&& code, auto&& visit) {
  draws.start(weight, threshold);
  do {
    code();
    visit();
  } while (draws.advance());
}

TEST("Heavy paths are enumerated, light ones sampled, and each end has its probability on average") {
  Sampler random{1};
  std::array<double, 8> sums{};
  constexpr int rounds = 20'000;
  for (int round = 0; round < rounds; ++round) {
    SplitDraws draws{random};
    std::array<double, 8> ends{};
    double total = 0;
    int end = 0;
    const auto code = [&] {
      end = 0;
      for (int draw = 0; draw < 3; ++draw) end = 2 * end + (draws.Bernoulli(0.8) ? 1 : 0);
    };
    walk(draws, 1, 0.5, code, [&] {
      ends[static_cast<std::size_t>(end)] += draws.weight();
      total += draws.weight();
      if (end == 7) EXPECT(draws.is_certain());
    });
    EXPECT_NEAR(total, 1, 1e-12);
    EXPECT_NEAR(ends[7], 0.8 * 0.8 * 0.8, 1e-12);
    for (std::size_t i = 0; i < ends.size(); ++i) sums[i] += ends[i];
  }
  EXPECT_NEAR(sums[0] / rounds, 0.008, 0.002);
  EXPECT_NEAR(sums[3] / rounds, 0.128, 0.005);
  EXPECT_NEAR(sums[4] / rounds, 0.032, 0.005);
}

TEST("The last draws of light paths are split too, so that a rare observation is weighed and not waited for") {
  Sampler random{2};
  SplitDraws draws{random};
  bool is_seen = false;
  double seen = 0;
  constexpr int states = 1'000;
  for (int state = 0; state < states; ++state) {
    const auto code = [&] {
      for (int draw = 0; draw < 9; ++draw) draws.Bernoulli(0.5);
      is_seen = draws.Bernoulli(0.0001);
    };
    walk(draws, 1.0 / states, 1, code, [&] { seen += is_seen ? draws.weight() : 0; });
  }
  EXPECT_NEAR(seen, 0.0001, 1e-6);
}

}
