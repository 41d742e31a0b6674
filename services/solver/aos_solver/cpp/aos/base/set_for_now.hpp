// Variables that have another value for a while.
#pragma once

#include <utility>

namespace aos {

// As long as this object lives, the variable has this value.
template <class T>
class SetForNow {
 public:
  SetForNow(T& variable, T value) : variable_(variable), before_(std::exchange(variable, std::move(value))) {}
  SetForNow(const SetForNow&) = delete;
  SetForNow& operator=(const SetForNow&) = delete;
  ~SetForNow() { variable_ = std::move(before_); }

 private:
  T& variable_;
  T before_;
};

}
