// The values that a mission sets. The engine gets them when it is started, before any state is made.
#pragma once

#include "aos/model/reflection.hpp"
#include "aos/model/state_text.hpp"

namespace aos {

// The parts of mission parameters that were set, with their values as StateReader reads them.
inline NamedTexts mission_values;

// Gives a mission parameter, or each part of it, the value that was set. What was not set stays as it is.
template <class T>
void take_mission_value(const std::string& name, T& value) {
  if (mission_values.empty()) return;
  if constexpr (Compound<T>) {
    T::aos_fields(value, [&](const char* field, auto& member) { take_mission_value(name + "." + field, member); });
  } else if constexpr (Enumerated<T>) {
    int index = 0;
    for (auto& element : value) {
      take_mission_value(name + "[" + name_of(static_cast<typename T::index_enum>(index++)) + "]", element);
    }
  } else if (const std::string* text = mission_values.find(name)) {
    StateReader reader{*text};
    reader.read(value);
    reader.finish();
  }
}

}
