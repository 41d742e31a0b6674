// The stream to which a document's print function writes a state.
#pragma once

#include <ostream>
#include <sstream>

#include "aos/model/reflection.hpp"

namespace aos {

// Writes enums by name. Other streams of document code write them as numbers, as C++ does.
class PrintedState {
 public:
  template <class T>
  PrintedState& operator<<(const T& value) {
    if constexpr (std::is_enum_v<T>) {
      stream_ << leaf_text(leaf_of(value));
    } else {
      stream_ << value;
    }
    return *this;
  }
  PrintedState& operator<<(std::ostream& (*manipulator)(std::ostream&)) {
    stream_ << manipulator;
    return *this;
  }
  std::string text() const { return stream_.str(); }

 private:
  std::ostringstream stream_;
};

}
