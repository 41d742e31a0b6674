// What is known of options, and which of them still earn something after another one. That their changes do not touch each other is not
// enough: to give something away changes no place, and asks for one, which a drive before it leaves. So what follows is tried.
#pragma once

#include "aos/base/switches.hpp"
#include "aos/planning/options/decision_clock.hpp"
#include "aos/planning/options/optimal_stopping.hpp"
#include "aos/planning/options/option_search.hpp"

namespace aos {

// An option, or a plan of tests, by the states from which it was taken.
struct KnownOption : StoppingChoice {
  Option way{};
  List<double> errors{};         // by state, squared
  std::vector<bool> changed{};  // by variable
  bool ends = false;             // the mission in some state, and earns nothing where it does not
  bool earns_without_end = false;
  bool is_tested = false;  // a plan, or an option that was weighed against tests
};

template <class Model>
class OptionSequels {
 public:
  using State = typename Model::State;

  // Forgets what was tried. Later calls take at most so many steps.
  void begin(const List<KnownOption>& options, const List<State>& states, const RunningDown<Model>* retries, const DecisionClock& clock,
             double steps, Sampler& random) {
    options_ = &options;
    states_ = &states;
    count_ = options.size();
    retries_ = retries;
    clock_ = &clock;
    left_ = std::max(steps, 0.0);
    luck_ = Sampler{random.bits()};
    known_.assign(count_ * count_, Known::open);
  }

  double left() const { return left_; }

  // Whether an option earns a fair part of what it earns, where another was taken before it. So it is without time or steps to try it.
  bool can_follow(std::size_t option, std::size_t before) {
    if (!switches::sequels) return true;
    Known& known = known_[before * count_ + option];
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
      const double earned = (*options_)[option].earned[k];
      if (earned <= 0) continue;
      if (left_ <= 0 || clock_->is_over()) return false;
      State state = (*states_)[k];
      taken_option<Model>((*options_)[before].way, state, luck_, retries_);
      left_ -= static_cast<double>((*options_)[before].way.size() + (*options_)[option].way.size());
      ++tried;
      if (Model::ending(state) != Ending::running) continue;
      alone += earned;
      behind += taken_option<Model>((*options_)[option].way, state, luck_, retries_).earned;
    }
    return behind < fair * alone;
  }

  const List<KnownOption>* options_ = nullptr;
  const List<State>* states_ = nullptr;
  std::size_t count_ = 0;  // of options, without later plans
  const RunningDown<Model>* retries_ = nullptr;
  const DecisionClock* clock_ = nullptr;
  double left_ = 0;  // of the steps
  Sampler luck_{1};
  List<Known> known_;  // [before * options + option]
};

}
