// Text of fixed storage for state variables of type `string`.
#pragma once

#include <string>
#include <string_view>

#include "aos/model/containers.hpp"

namespace aos {

// Holds up to `max_length` characters in place, so that a state stays trivially copyable. A Text reads and
// changes like a std::string. Longer text is a ModelFault.
class Text : public Elements<Text, char> {
 public:
  static constexpr std::size_t max_length = 62;
  static constexpr std::size_t npos = std::string::npos;

  Text() = default;
  Text(const char* text) { assign(text); }
  Text(std::string_view text) { assign(text); }
  Text(const std::string& text) { assign(text); }
  Text(auto first, auto second) : Text(std::string(first, second)) {}

  Text& operator+=(std::string_view more) {
    if (length_ + more.size() > max_length) overflow(length_ + more.size());
    more.copy(characters_ + length_, more.size());
    set_length(length_ + more.size());
    return *this;
  }
  Text& operator+=(char more) { return *this += std::string_view{&more, 1}; }
  void push_back(char more) { *this += more; }
  void clear() { set_length(0); }
  void assign(std::string_view text) {
    if (text.size() > max_length) overflow(text.size());
    text.copy(characters_, text.size());
    set_length(text.size());
  }
  Text& append(std::string_view more) { return *this += more; }
  template <class Other>
  void swap(Other& other) {
    const std::string mine(*this);
    assign(other);
    other = mine;
  }
  void pop_back() { set_length(checked(length_ - std::size_t{1})); }
  void resize(std::size_t size, char filling = '\0') {
    changed([&](std::string& text) { text.resize(size, filling); });
  }
  Text& append(auto first, auto second) {
    return changed([&](std::string& text) { text.append(first, second); });
  }
  void assign(auto first, auto second) { *this = Text(first, second); }
  Text& insert(auto... arguments) {
    return changed([&](std::string& text) { text.insert(in(text, arguments)...); });
  }
  Text& erase(auto... arguments) {
    return changed([&](std::string& text) { text.erase(in(text, arguments)...); });
  }
  Text& replace(auto... arguments) {
    return changed([&](std::string& text) { text.replace(in(text, arguments)...); });
  }

  operator std::string() const { return str(); }
  operator std::string_view() const { return view(); }
  std::string str() const { return std::string{view()}; }
  std::string_view view() const { return {characters_, length_}; }
  const char* c_str() const { return characters_; }
  const char* data() const { return characters_; }
  char* data() { return characters_; }

  std::size_t size() const { return length_; }
  std::size_t length() const { return length_; }
  bool empty() const { return length_ == 0; }
  char& operator[](std::size_t index) { return characters_[checked(index)]; }
  const char& operator[](std::size_t index) const { return characters_[checked(index)]; }
  std::string substr(std::size_t from = 0, std::size_t count = npos) const { return str().substr(from, count); }
  auto find(const auto&... sought) const { return view().find(sought...); }
  auto rfind(const auto&... sought) const { return view().rfind(sought...); }
  auto find_first_of(const auto&... sought) const { return view().find_first_of(sought...); }
  auto find_last_of(const auto&... sought) const { return view().find_last_of(sought...); }
  auto find_first_not_of(const auto&... sought) const { return view().find_first_not_of(sought...); }
  auto find_last_not_of(const auto&... sought) const { return view().find_last_not_of(sought...); }
  bool starts_with(const auto& part) const { return view().starts_with(part); }
  bool ends_with(const auto& part) const { return view().ends_with(part); }
  int compare(const auto&... others) const { return view().compare(others...); }

  friend bool operator==(const Text& left, const Text& right) { return left.view() == right.view(); }
  friend auto operator<=>(const Text& left, const Text& right) { return left.view() <=> right.view(); }
  friend std::string operator+(const Text& left, const Text& right) { return left.str().append(right.view()); }
  friend std::string operator+(const Text& left, char right) { return left.str() + right; }
  friend std::string operator+(char left, const Text& right) { return left + right.str(); }
  friend auto& operator>>(auto& in, Text& text) {
    std::string word;
    in >> word;
    text = word;
    return in;
  }
  friend auto& getline(auto& in, Text& text, char end = '\n') {
    std::string line;
    std::getline(in, line, end);
    text = line;
    return in;
  }
  template <class Stream>
  friend Stream& operator<<(Stream& out, const Text& text) { return static_cast<Stream&>(out << text.view()); }

 private:
  std::size_t checked(std::size_t index) const {
    if (index < length_) return index;
    no_character(static_cast<std::ptrdiff_t>(index), length_);
  }
  [[noreturn, gnu::cold]] static void no_character(std::ptrdiff_t index, std::size_t size);
  [[noreturn, gnu::cold]] static void overflow(std::size_t size);

  // An iterator of this text as one of its copy; what is no iterator as it is.
  auto in(std::string& copy, auto argument) const {
    if constexpr (std::is_same_v<decltype(argument), char*>) {
      return copy.begin() + (argument - characters_);
    } else {
      return argument;
    }
  }
  Text& changed(auto&& change) {
    std::string text = str();
    change(text);
    assign(text);
    return *this;
  }
  void set_length(std::size_t length) {
    characters_[length] = '\0';
    length_ = static_cast<std::uint8_t>(length);
  }

  char characters_[max_length + 1] = {};
  std::uint8_t length_ = 0;
};

}
