// Puts off tries that were in vain: for 1, 3, 7 and 15 decisions after so many in a row.
#pragma once

#include <algorithm>

namespace aos {

class Backoff {
 public:
  // So many tries in vain put nothing off.
  explicit Backoff(int harmless = 0) : harmless_(harmless), in_vain_(-harmless) {}

  // Whether it is time for a try. Each decision without one counts.
  bool is_due() {
    if (put_off_ == 0) return true;
    --put_off_;
    return false;
  }
  void fail() { put_off_ = (1 << std::min(++in_vain_, most_in_vain)) - 1; }
  void succeed() { in_vain_ = -harmless_; }

 private:
  static constexpr int most_in_vain = 4;  // 15 decisions pass then; nobody has varied it

  int harmless_;
  int in_vain_;      // tries in a row
  int put_off_ = 0;  // decisions without a try
};

}
