// Text of fixed storage for state variables of type `string`.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

#include "aos/fault.hpp"

namespace aos {

// Holds up to `room` characters in place, so that a state stays trivially copyable. It reads as a std::string and
// takes assignments and in-place changes like one; longer text is a ModelFault.
class Text {
 public:
  static constexpr std::size_t room = 62;
  static constexpr std::size_t npos = std::string::npos;

  Text() = default;
  Text(const char* text) { assign(text); }
  Text(std::string_view text) { assign(text); }
  Text(const std::string& text) { assign(text); }

  Text& operator+=(std::string_view more) {
    if (length_ + more.size() > room) overflow(length_ + more.size());
    more.copy(characters_ + length_, more.size());
    length_ = static_cast<std::uint8_t>(length_ + more.size());
    return *this;
  }
  Text& operator+=(char more) { return *this += std::string_view{&more, 1}; }
  void push_back(char more) { *this += more; }
  void clear() { length_ = 0; }
  void assign(std::string_view text) {
    if (text.size() > room) overflow(text.size());
    text.copy(characters_, text.size());
    length_ = static_cast<std::uint8_t>(text.size());
  }

  operator std::string() const { return str(); }
  operator std::string_view() const { return view(); }
  std::string str() const { return std::string{view()}; }
  std::string_view view() const { return {characters_, length_}; }

  std::size_t size() const { return length_; }
  std::size_t length() const { return length_; }
  bool empty() const { return length_ == 0; }
  char& operator[](std::size_t index) { return characters_[checked(index)]; }
  const char& operator[](std::size_t index) const { return characters_[checked(index)]; }
  char& at(std::size_t index) { return (*this)[index]; }
  const char& at(std::size_t index) const { return (*this)[index]; }
  char& front() { return (*this)[0]; }
  char& back() { return (*this)[length_ - std::size_t{1}]; }
  char* begin() { return characters_; }
  char* end() { return characters_ + length_; }
  const char* begin() const { return characters_; }
  const char* end() const { return characters_ + length_; }
  const char* cbegin() const { return begin(); }
  const char* cend() const { return end(); }
  std::string substr(std::size_t from = 0, std::size_t count = npos) const { return str().substr(from, count); }
  std::size_t find(std::string_view part, std::size_t from = 0) const { return view().find(part, from); }
  std::size_t find(char part, std::size_t from = 0) const { return view().find(part, from); }
  int compare(std::string_view other) const { return view().compare(other); }

  friend bool operator==(const Text& left, const Text& right) { return left.view() == right.view(); }
  friend auto operator<=>(const Text& left, const Text& right) { return left.view() <=> right.view(); }
  friend std::string operator+(const Text& left, const Text& right) { return left.str().append(right.view()); }
  friend std::string operator+(const Text& left, char right) { return left.str() + right; }

 private:
  std::size_t checked(std::size_t index) const {
    if (index < length_) return index;
    throw ModelFault{"AOS215", "character " + std::to_string(static_cast<long long>(index)) + " of a text of " +
                                   std::to_string(length_) + " characters"};
  }
  [[noreturn]] static void overflow(std::size_t size) {
    throw ModelFault{"AOS215", "a text of " + std::to_string(size) + " characters; a state variable of type string holds " +
                                   std::to_string(room)};
  }

  char characters_[room] = {};
  std::uint8_t length_ = 0;
};

}  // namespace aos
