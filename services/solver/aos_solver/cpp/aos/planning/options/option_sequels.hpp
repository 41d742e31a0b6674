// Which options still earn something after another one. That their changes do not touch each other is not enough: to give
// something away changes no place, and asks for one, which a drive before it leaves. So what follows is tried.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/option_search.hpp"

namespace aos {

template <class Model>
class OptionSequels {
 public:
  using State = typename Model::State;

  // Forgets what was tried. Later calls take at most so many steps. `earned` has what each option earns from each state.
  void begin(const List<Option>& options, const List<State>& states, const List<double>& earned, const RunningDown<Model>* retries,
             const DecisionClock& clock, double steps, Sampler& random) {
    options_ = &options;
    states_ = &states;
    earned_ = &earned;
    retries_ = retries;
    clock_ = &clock;
    left_ = std::max(steps, 0.0);
    luck_ = Sampler{random.bits()};
    known_.assign(options.size() * options.size(), Known::open);
  }

  double left() const { return left_; }

  // Whether an option earns a fair part of what it earns, where another was taken before it. So it is without time or steps to try it.
  bool can_follow(std::size_t option, std::size_t before) {
    if (!switches::sequels) return true;
    Known& known = known_[before * options_->size() + option];
    if (known == Known::open) known = is_spoiled(option, before) ? Known::no : Known::yes;
    return known == Known::yes;
  }

 private:
  enum class Known : char { open, no, yes };
  static constexpr std::size_t tries = 16;
  static constexpr double fair = 0.25;

  bool is_spoiled(std::size_t option, std::size_t before) {
    double alone = 0;
    double behind = 0;
    std::size_t tried = 0;
    for (std::size_t k = 0; k < states_->size() && tried < tries; ++k) {
      const double earned = (*earned_)[option * states_->size() + k];
      if (earned <= 0) continue;
      if (left_ <= 0 || clock_->is_over()) return false;
      State state = (*states_)[k];
      taken_option<Model>((*options_)[before], state, luck_, retries_);
      left_ -= static_cast<double>((*options_)[before].size() + (*options_)[option].size());
      ++tried;
      if (Model::ending(state) != Ending::running) continue;
      alone += earned;
      behind += taken_option<Model>((*options_)[option], state, luck_, retries_).earned;
    }
    return behind < fair * alone;
  }

  const List<Option>* options_ = nullptr;
  const List<State>* states_ = nullptr;
  const List<double>* earned_ = nullptr;  // [option * states + state]
  const RunningDown<Model>* retries_ = nullptr;
  const DecisionClock* clock_ = nullptr;
  double left_ = 0;  // of the steps
  Sampler luck_{1};
  List<Known> known_;  // [before * options + option]
};

}
