// Learns which draws of the origin no observation depends on, from moves that change several of them at once:
// group testing (Dorfman, 1943) with scores in place of certainty.
//
// Whatever is far away is drawn at the origin and matters later. Such draws can be made anew together, in one
// move that is nearly always accepted. One draw at a time would take as many moves as there are draws.
#pragma once

#include "aos/draws/random.hpp"

namespace aos {

class FreeDraws {
 public:
  // Chooses a set of draws to make anew. The choice does not depend on the draws' values, so that the way
  // back is as likely. The size of the set is of any scale, so that few draws are tried, too.
  const List<std::size_t>& choose(std::size_t count, Sampler& random) {
    if (scores_.size() < count) scores_.resize(count, unknown);
    const double scale = std::exp(-random.uniform() * std::log(static_cast<double>(scores_.size()) + 1));
    chosen_.clear();
    for (std::size_t draw = 0; draw < scores_.size(); ++draw) {
      if (random.flag(scale * scores_[draw] * scores_[draw])) chosen_.push_back(draw);
    }
    return chosen_;
  }

  // The share of proposals to make in this way, by how often they succeeded lately. At least half of the
  // proposals are left to draws that observations depend on, and to those of later steps.
  double share() const { return std::clamp(acceptance_, 0.25, 0.5); }

  // Learns whether the last set of draws could be made anew. If not, draws with lower scores are blamed more.
  void note(bool was_accepted) {
    acceptance_ += 0.02 * ((was_accepted ? 1 : 0) - acceptance_);
    double doubts = 0;
    for (const std::size_t draw : chosen_) doubts += doubt(draw);
    for (const std::size_t draw : chosen_) {
      double& score = scores_[draw];
      score = was_accepted ? score + gain * (1 - score) : score * (1 - loss * doubt(draw) / doubts);
    }
  }

 private:
  static constexpr double unknown = 0.5;
  static constexpr double gain = 0.3;
  static constexpr double loss = 0.7;

  // No draw is trusted fully, since later observations may depend on it.
  double doubt(std::size_t draw) const { return 1.02 - scores_[draw]; }

  double acceptance_ = 0.5;
  List<double> scores_;  // in [0, 1]
  List<std::size_t> chosen_;
};

}
