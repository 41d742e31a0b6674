// The value of an action by the statements of documents that give its rewards.
#pragma once

#include <map>

#include "aos/base/reward_ledger.hpp"
#include "aos/base/set_for_now.hpp"
#include "aos/draws/enumerator.hpp"
#include "aos/model/step.hpp"
#include "aos/text/json.hpp"

namespace aos {

// The expected rewards of steps, by statement.
template <class Model>
class RewardTerms {
 public:
  // Adds the expected rewards of a step, so many times, and returns how many paths it has. Throws NotEnumerable.
  int add(const typename Model::State& state, int action, double times, int max_paths = path_budget) {
    RewardLedger ledger;
    const SetForNow using_it{reward_ledger, &ledger};
    typename Model::State next{};
    Step step;
    const auto run = [&](Enumerator& path) {
      ledger.clear();
      next = state;
      step = Model::step(next, action, path);
    };
    draws_.report_to(&ignored_numbers);
    int paths = 0;
    const auto visit = [&](Enumerator& path) {
      ++paths;
      count(ledger, step, times * path.probability());
    };
    draws_.for_nearly_each_path(run, visit, max_paths);
    return paths;
  }

  void add_drawn(typename Model::State state, int action, double times, Sampler& random) {
    RewardLedger ledger;
    const SetForNow using_it{reward_ledger, &ledger};
    const Step step = Model::step(state, action, random);
    count(ledger, step, times);
    ++drawn_;
  }

  // `drawn` tells how many steps were drawn; 0 where the rewards are expected ones.
  void write(JsonWriter& json) const {
    json.begin_object().member("total", total_).member("drawn", drawn_).key("terms").begin_array();
    for (const auto& [source, amount] : terms_) {
      json.begin_object().member("place", source.first).member("skill", source.second);
      json.member("amount", amount).end_object();
    }
    json.end_array().end_object();
  }

 private:
  void count(const RewardLedger& ledger, const Step& step, double times) {
    for (const RewardTerm& term : ledger.terms()) {
      terms_[{term.place, term.skill == nullptr ? "" : term.skill}] += times * term.amount;
    }
    total_ += times * step.reward;
  }

  Enumerator draws_;
  std::map<std::pair<std::uint32_t, std::string>, double> terms_;
  double total_ = 0;
  int drawn_ = 0;
};

}
