// Text of fixed storage for state variables of type `string`.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace aos {

// Holds up to `max_length` characters in place, so that a state stays trivially copyable. A Text reads and
// changes like a std::string. Longer text is a ModelFault.
class Text {
 public:
  static constexpr std::size_t max_length = 62;
  static constexpr std::size_t npos = std::string::npos;

  Text() = default;
  Text(const char* text) { assign(text); }
  Text(std::string_view text) { assign(text); }
  Text(const std::string& text) { assign(text); }

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
  void pop_back() { set_length(checked(length_ - std::size_t{1})); }
  void resize(std::size_t size, char filling = '\0') {
    changed([&](std::string& text) { text.resize(size, filling); });
  }
  template <class... Arguments>
  Text& insert(Arguments... arguments) {
    return changed([&](std::string& text) { text.insert(arguments...); });
  }
  template <class... Arguments>
  Text& erase(Arguments... arguments) {
    return changed([&](std::string& text) { text.erase(arguments...); });
  }
  template <class... Arguments>
  Text& replace(Arguments... arguments) {
    return changed([&](std::string& text) { text.replace(arguments...); });
  }

  operator std::string() const { return str(); }
  operator std::string_view() const { return view(); }
  std::string str() const { return std::string{view()}; }
  std::string_view view() const { return {characters_, length_}; }
  const char* c_str() const { return characters_; }

  std::size_t size() const { return length_; }
  std::size_t length() const { return length_; }
  bool empty() const { return length_ == 0; }
  char& operator[](std::size_t index) { return characters_[checked(index)]; }
  const char& operator[](std::size_t index) const { return characters_[checked(index)]; }
  char& at(std::size_t index) { return (*this)[index]; }
  const char& at(std::size_t index) const { return (*this)[index]; }
  char& front() { return (*this)[0]; }
  char& back() { return (*this)[length_ - std::size_t{1}]; }
  const char& front() const { return (*this)[0]; }
  const char& back() const { return (*this)[length_ - std::size_t{1}]; }
  char* begin() { return characters_; }
  char* end() { return characters_ + length_; }
  const char* begin() const { return characters_; }
  const char* end() const { return characters_ + length_; }
  const char* cbegin() const { return begin(); }
  const char* cend() const { return end(); }
  auto rbegin() const { return view().rbegin(); }
  auto rend() const { return view().rend(); }
  std::string substr(std::size_t from = 0, std::size_t count = npos) const { return str().substr(from, count); }
  std::size_t find(std::string_view part, std::size_t from = 0) const { return view().find(part, from); }
  std::size_t find(char part, std::size_t from = 0) const { return view().find(part, from); }
  std::size_t rfind(std::string_view part, std::size_t from = npos) const { return view().rfind(part, from); }
  std::size_t rfind(char part, std::size_t from = npos) const { return view().rfind(part, from); }
  std::size_t find_first_of(std::string_view any, std::size_t from = 0) const { return view().find_first_of(any, from); }
  std::size_t find_last_of(std::string_view any, std::size_t from = npos) const { return view().find_last_of(any, from); }
  std::size_t find_first_not_of(std::string_view any, std::size_t from = 0) const {
    return view().find_first_not_of(any, from);
  }
  std::size_t find_last_not_of(std::string_view any, std::size_t from = npos) const {
    return view().find_last_not_of(any, from);
  }
  bool starts_with(std::string_view part) const { return view().starts_with(part); }
  bool ends_with(std::string_view part) const { return view().ends_with(part); }
  int compare(std::string_view other) const { return view().compare(other); }

  friend bool operator==(const Text& left, const Text& right) { return left.view() == right.view(); }
  friend auto operator<=>(const Text& left, const Text& right) { return left.view() <=> right.view(); }
  friend std::string operator+(const Text& left, const Text& right) { return left.str().append(right.view()); }
  friend std::string operator+(const Text& left, char right) { return left.str() + right; }
  template <class Stream>
  friend Stream& operator<<(Stream& out, const Text& text) { return static_cast<Stream&>(out << text.view()); }

 private:
  std::size_t checked(std::size_t index) const {
    if (index < length_) return index;
    no_character(static_cast<std::ptrdiff_t>(index), length_);
  }
  [[noreturn, gnu::cold]] static void no_character(std::ptrdiff_t index, std::size_t size);
  [[noreturn, gnu::cold]] static void overflow(std::size_t size);

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
