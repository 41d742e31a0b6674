// What a state is worth if it is seen: known options are followed, one after the other, up to the horizon. Where none of
// them earns anything, a search looks for another one.
#pragma once

#include "aos/planning/options/option_library.hpp"
#include "aos/planning/options/option_search.hpp"

namespace aos {

// What options earn that are followed, and the discount of what comes after them, which is 0 where the mission has ended.
struct Followed {
  double earned = 0;
  double discount = 1;
};

template <class Model>
class OptionFollowing {
 public:
  using State = typename Model::State;

  explicit OptionFollowing(const OptionLibrary<Model>& library) : library_(library) {}

  // Begins a decision: what searches have found since the last one is forgotten.
  void begin() { found_.clear(); }

  // Follows options for so many steps of a mission. It takes about `most_steps` of the model; `steps` is counted down.
  Followed follow(State state, std::size_t horizon, double most_steps, double& steps, Sampler& random) const {
    Followed followed;
    double left = most_steps;
    while (Model::ending(state) == Ending::running && left > 0 && !library_.clock().is_over()) {
      Best best = best_known(state, horizon, left, random);
      if (best.option.empty()) best = best_searched(state, horizon, left, random);
      if (best.option.empty()) break;
      followed.earned += followed.discount * best.earned;
      followed.discount *= std::pow(Model::discount, best.option.size());
      horizon -= best.option.size();
      state = std::move(best.after);
    }
    if (Model::ending(state) != Ending::running) followed.discount = 0;
    steps -= most_steps - left;
    return followed;
  }

 private:
  static constexpr std::size_t tried_again = 3;  // options that earned most at the first try
  static constexpr int tries = 4;                // of each of them
  static constexpr std::size_t most_found = 64;

  struct Best {
    Option option{};
    double earned = 0;  // on average
    State after{};      // of the last try
  };

  struct Tried {
    double income;
    const Option* option;
    double earned;
    bool ends;  // the mission
  };

  Best best_known(const State& state, std::size_t horizon, double& left, Sampler& random) const {
    first_.clear();
    for (const List<Option>* options : {&library_.options(), &std::as_const(found_)}) {
      for (const Option& option : *options) {
        if (option.size() > horizon) continue;
        State next = state;
        const double earned = taken_option<Model>(option, next, random, library_.retries()).earned;
        left -= option.size();
        if (earned > 0) first_.push_back({income<Model>(earned, option.size()), &option, earned, Model::ending(next) != Ending::running});
      }
    }
    const auto count = static_cast<std::ptrdiff_t>(std::min(tried_again, first_.size()));
    const auto sort_first = [&](auto&& comes_before) { std::partial_sort(first_.begin(), first_.begin() + count, first_.end(), comes_before); };
    sort_first([](const Tried& one, const Tried& other) { return one.income > other.income; });
    // After an end nothing is earned, so that ends compare by what they earn in all.
    const bool ends = !first_.empty() && first_.front().ends;
    if (ends) sort_first([](const Tried& one, const Tried& other) { return std::pair(one.ends, one.earned) > std::pair(other.ends, other.earned); });
    Best best;
    double most = 0;
    for (auto entry = first_.begin(); entry != first_.begin() + count; ++entry) {
      Best again = tried(*entry->option, state, left, random);
      const double now = ends ? again.earned : income<Model>(again.earned, again.option.size());
      if (now <= most) continue;
      most = now;
      best = std::move(again);
    }
    return best;
  }

  Best best_searched(const State& state, std::size_t horizon, double& left, Sampler& random) const {
    OptionSearch<Model> search{library_.searched_cells(), library_.clock(), library_.retries(), library_.counts()};
    const List<Option> ways = search.from(state, left, random);
    if (ways.empty() || ways.front().size() > horizon) return {};
    if (found_.size() < most_found) found_.push_back(ways.front());
    return tried(ways.front(), state, left, random);
  }

  Best tried(const Option& option, const State& state, double& left, Sampler& random) const {
    Best best{option, 0, state};
    for (int i = 0; i < tries; ++i) {
      best.after = state;
      best.earned += taken_option<Model>(option, best.after, random, library_.retries()).earned / tries;
    }
    left -= tries * static_cast<double>(option.size());
    return best;
  }

  const OptionLibrary<Model>& library_;
  mutable List<Tried> first_;
  mutable List<Option> found_;
};

}
