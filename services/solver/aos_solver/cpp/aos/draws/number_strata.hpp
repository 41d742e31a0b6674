// DrawStrata of a continuous draw: what model code does with the middle of each stands for what it does in all of it.
#pragma once

#include <array>

namespace aos {

// Weights and middles of the strata of a number in [0, 1), which is the probability of what is drawn. Most are equally wide. Of
// the `ends` strata at each end each is half as wide as the one before, so that rare draws are met as well.
template <int count, int ends>
struct NumberStrata {
  std::array<double, count> weights{};
  std::array<double, count> middles{};

  constexpr NumberStrata() {
    constexpr double width = 1.0 / (count - 2 * ends + 4);
    constexpr double end = 2 * width;
    double from = 0;
    for (int i = 0; i < count; ++i) {
      const int to_end = i < count - 1 - i ? i : count - 1 - i;
      const int halves = to_end == 0 ? ends - 1 : ends - to_end;
      const double weight = to_end < ends ? end / (1 << halves) : width;
      weights[i] = weight;
      middles[i] = from + weight / 2;
      from += weight;
    }
  }
};
inline constexpr NumberStrata<240, 12> fine_strata;
inline constexpr NumberStrata<60, 12> middling_strata;  // two draws of a step have fewer combinations than are walked
inline constexpr NumberStrata<15, 3> coarse_strata;     // three draws have

// DrawStrata to draw from; none where the count is 0.
struct DrawStrata {
  const double* weights = nullptr;
  const double* middles = nullptr;
  int count = 0;

  template <class Of>
  static constexpr DrawStrata of(const Of& strata) {
    return {strata.weights.data(), strata.middles.data(), static_cast<int>(strata.weights.size())};
  }
  // The standard deviation of the probability that a draw is above some number, if that is anywhere in a stratum of the middle.
  constexpr double error() const { return count == 0 ? 0 : 0.2887 * weights[count / 2]; }
  // Those to try next where there are too many combinations.
  constexpr DrawStrata coarser() const {
    return count > 60 ? of(middling_strata) : count > 15 ? of(coarse_strata) : DrawStrata{};
  }
};

}
