// Which statements of documents gave a reward. A study looks at steps with a ledger; nobody else has one.
#pragma once

#include <cmath>
#include <cstdint>

#include "aos/base/list.hpp"

namespace aos {

inline constexpr double largest_reward = 1e100;  // The squares of returns can be added up.
inline bool is_reward(double number) { return std::abs(number) <= largest_reward; }

struct RewardTerm {
  std::uint32_t place = 0;     // the statement's number, as blame.hpp counts; 0 for a penalty
  const char* skill = nullptr;  // whose precondition was violated, where that is the reason
  double amount = 0;
};

class RewardLedger {
 public:
  void clear() {
    terms_.clear();
    of_phase_ = 0;
  }
  void add(std::uint32_t place, double amount, const char* skill = nullptr);
  // Ends a phase of the step: what its reward has beyond the terms of its statements is given to a place.
  void end_phase(std::uint32_t place, double reward, const char* skill = nullptr) {
    add(place, reward - of_phase_, skill);
    of_phase_ = 0;
  }

  const List<RewardTerm>& terms() const { return terms_; }

 private:
  List<RewardTerm> terms_;
  double of_phase_ = 0;
};

// The ledger of the study that runs; null where there is none. One thread has one.
inline RewardLedger* reward_ledger = nullptr;

}
