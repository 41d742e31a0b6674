// `__observed` of model code. The source of draws reports each number to which a distribution is assigned.
#pragma once

#include "aos/draws/distributions.hpp"
#include "aos/draws/number_key.hpp"

namespace aos {

[[noreturn, gnu::cold]] void no_such_element(std::ptrdiff_t index);

// One number, or one element of an array.
template <class Source>
class ReportedNumber {
 public:
  ReportedNumber(Source& source, NumberKey key) : source_(source), key_(key) {}
  void operator=(const Distribution& distribution) { source_.report(key_, distribution); }

 private:
  Source& source_;
  NumberKey key_;
};

// An array of numbers. A bad index is a ModelFault.
template <class Source>
class ReportedNumbers {
 public:
  ReportedNumbers(Source& source, NumberKey first) : source_(source), first_(first) {}
  ReportedNumber<Source> operator[](std::ptrdiff_t index) {
    if (index < 0 || index >= std::ptrdiff_t{1} << number_index_bits) no_such_element(index);
    return {source_, first_ + static_cast<NumberKey>(index)};
  }
  void push_back(const Distribution& distribution) { (*this)[count_++] = distribution; }

 private:
  Source& source_;
  NumberKey first_;
  std::ptrdiff_t count_ = 0;
};

}
