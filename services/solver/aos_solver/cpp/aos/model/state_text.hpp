// A state as one line of text and back, for beliefs that outlive their process.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "aos/model/reflection.hpp"

namespace aos {

// Numbers separated by blanks: every leaf is a number, vectors and texts begin with their size, floating point is
// written as its bits.
class StateWriter {
 public:
  void write(AnyValue value);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// Reads what a StateWriter wrote. What is a constant here is read past: it has its value already.
class StateReader {
 public:
  explicit StateReader(std::string_view text) : rest_(text) {}

  template <class T>
  void read(T& value) {
    if constexpr (std::is_const_v<T>) {
      std::remove_const_t<T> ignored = value;
      read(ignored);
    } else if constexpr (Compound<T>) {
      T::__fields(value, [this](const char*, auto& member) { read(member); });
    } else if constexpr (Mapping<T>) {
      for (auto& entry : value) read(entry.second);
    } else if constexpr (std::derived_from<T, std::vector<bool>>) {
      value.resize(static_cast<std::size_t>(next()));
      for (auto element : value) element = next() != 0;
    } else if constexpr (Sequence<T> || std::same_as<T, Text> || std::same_as<T, std::string>) {
      resize(value, static_cast<std::size_t>(next()));
      for (auto& element : value) read(element);
    } else if constexpr (std::floating_point<T>) {
      value = static_cast<T>(std::bit_cast<double>(next()));
    } else {
      value = static_cast<T>(next());
    }
  }
  void finish() const {
    if (!rest_.empty()) malformed();
  }

 private:
  [[noreturn]] static void malformed();

  template <class T>
  static void resize(T& value, std::size_t size) {
    if constexpr (requires { value.resize(size); }) {
      value.resize(size);
    } else if constexpr (std::same_as<T, Text>) {
      value = std::string(size, ' ');
    } else if (size != value.size()) {
      malformed();
    }
  }
  std::int64_t next();

  std::string_view rest_;
};

// The variables that are constants where states are saved, by name: what need not be saved with each of them.
class SavedConstants {
 public:
  void add(std::string_view name, AnyValue value);
  void add_text(std::string_view name, std::string_view text) { texts_.emplace_back(name, text); }
  const std::vector<std::pair<std::string, std::string>>& texts() const { return texts_; }

  // The value of a variable from here if it was a constant, or else from the rest of a saved state.
  template <class T>
  void read(std::string_view name, T& value, StateReader& state) const {
    const std::string* const constant = find(name);
    if (constant == nullptr) return state.read(value);
    if constexpr (!std::is_const_v<T>) {
      StateReader text{*constant};
      text.read(value);
      text.finish();
    }
  }

 private:
  const std::string* find(std::string_view name) const;

  std::vector<std::pair<std::string, std::string>> texts_;
};

}  // namespace aos
