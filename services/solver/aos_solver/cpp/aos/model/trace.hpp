// What tracing adds to document code: see trace.py. A model that plans has none of it.
#pragma once

#include <cmath>
#include <cstdint>
#include <exception>
#include <type_traits>

#include "aos/model/blame.hpp"

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
// that statement is blamed. A reward blames the statement that made it infinite or NaN; a response blames the
// last one that set it.
template <class Result>
class Giving {
 public:
  explicit Giving(const Result& result) : result_(result) {}
  Giving(const Giving&) = delete;
  Giving& operator=(const Giving&) = delete;
  ~Giving() {
    if (place_ != 0 && std::uncaught_exceptions() == exceptions_) at(place_);
  }

  void by(std::uint32_t place) {
    if constexpr (std::is_floating_point_v<Result>) {
      if (std::isfinite(result_)) {
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
  std::uint32_t place_ = 0;
  int exceptions_ = std::uncaught_exceptions();
};

}  // namespace aos::blame
