// The value of an action by the statements of documents that give its rewards.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "aos/base/enumerator.hpp"
#include "aos/base/json.hpp"
#include "aos/base/reward_ledger.hpp"
#include "aos/model/step.hpp"

namespace aos {

// The expected rewards of steps, by statement.
template <class Model>
class RewardTerms {
 public:
  // Adds the expected rewards of a step, so many times. Throws NotEnumerable.
  void add(const typename Model::State& state, int action, double times) {
    RewardLedger ledger;
    reward_ledger = &ledger;
    const Using done;
    typename Model::State next{};
    Step step;
    const auto run = [&](Enumerator& path) {
      ledger.clear();
      next = state;
      step = Model::step(next, action, path);
    };
    draws_.report_to(&ignored_numbers);
    draws_.for_nearly_each_path(run, [&](Enumerator& path) {
      const double weight = times * path.probability();
      for (const RewardTerm& term : ledger.terms()) {
        terms_[{term.place, term.skill == nullptr ? "" : term.skill}] += weight * term.amount;
      }
      total_ += weight * step.reward;
    });
  }

  void write(JsonWriter& json) const {
    json.begin_object().member("total", total_).key("terms").begin_array();
    for (const auto& [source, amount] : terms_) {
      json.begin_object().member("place", source.first).member("skill", source.second);
      json.member("amount", amount).end_object();
    }
    json.end_array().end_object();
  }

 private:
  struct Using {
    ~Using() { reward_ledger = nullptr; }
  };

  Enumerator draws_;
  std::map<std::pair<std::uint32_t, std::string>, double> terms_;
  double total_ = 0;
};

}  // namespace aos
