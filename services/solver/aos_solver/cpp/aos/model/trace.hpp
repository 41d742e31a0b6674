// What tracing adds to document code: see trace.py. A model that plans has none of it.
#pragma once

#include <exception>
#include <vector>

#include "aos/base/fault.hpp"
#include "aos/base/reward_ledger.hpp"
#include "aos/base/set_for_now.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/reflection.hpp"

namespace aos::blame {

// An object in the body of a lambda. After the body, the caller's statement runs again, unless the body throws.
class Inside {
 public:
  Inside() = default;
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  ~Inside() {
    if (std::uncaught_exceptions() == exceptions_) at(caller_);
  }

 private:
  std::uint32_t caller_ = piece();
  int exceptions_ = std::uncaught_exceptions();
};

// Remembers the statement that gave a result. A wrong result shows only when its section is over, and then
// that statement is blamed. A reward blames the statement that made it too large or NaN; a response blames the
// last one that set it. In a study, each statement has in the ledger by how much it changed the reward.
template <class Result>
class Giving {
 public:
  explicit Giving(const Result& result) : result_(result), before_(result) {}
  Giving(const Giving&) = delete;
  Giving& operator=(const Giving&) = delete;
  ~Giving() {
    if (place_ != 0 && std::uncaught_exceptions() == exceptions_) at(place_);
  }

  void by(std::uint32_t place) {
    if constexpr (std::is_floating_point_v<Result>) {
      if (reward_ledger != nullptr) reward_ledger->add(place, result_ - std::exchange(before_, result_));
      if (is_reward(result_)) {
        place_ = 0;
      } else if (place_ == 0) {
        place_ = place;
      }
    } else {
      place_ = place;
    }
  }

 private:
  const Result& result_;
  Result before_;
  std::uint32_t place_ = 0;
  int exceptions_ = std::uncaught_exceptions();
};

// A copy of the state that a piece names, with the variables that it names; all where it names none.
struct Shown {
  const char* name;
  AnyValue state;
  std::initializer_list<std::string_view> members;
};

// An object at the start of a piece: what can be told if the piece does not come to an end.
class Showing {
 public:
  explicit Showing(std::initializer_list<Shown> copies) : copies_(copies) { tells_state = true; }

  // Tells the state, at the first of the statements that go on running: the head of their loop.
  static void tell(std::uint32_t place) {
    constexpr int enough = 100'000;
    thread_local std::uint32_t head = place;
    thread_local std::uint32_t ends_before = ends();
    thread_local int looked_at = 0;
    if (looked_at == 0) {
      head = place;
      ends_before = ends();
    }
    head = place < head ? place : head;
    const bool has_ended = ends() != ends_before;  // It took long and came to an end.
    if (!has_ended && ++looked_at < enough) return;
    is_state_wanted = false;
    looked_at = 0;
    if (has_ended) return;
    at(head);
    std::string text;
    if (innermost != nullptr) {
      for (const Shown& copy : innermost->copies_) {
        const std::string values = leaves_text(copy.name, copy.state, copy.members);
        if (!values.empty()) text += (text.empty() ? ", with " : ", ") + values;
      }
    }
    throw ModelFault{"AOS211", "this code does not come to an end" + text};
  }

 private:
  inline static thread_local const Showing* innermost = nullptr;
  std::vector<Shown> copies_;
  SetForNow<const Showing*> now_{innermost, this};
};

// Notes the statement that runs. Where the watchdog waits for code to end, that is told with the state.
inline void statement(std::uint32_t place) {
  at(place);
  if (is_state_wanted) Showing::tell(place);
}

}
