// A writer of JSON that keeps no document tree in memory.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <string>

#include "aos/text/utf8.hpp"

namespace aos {

// The shortest text that reads back as the same number.
inline std::string number_text(auto number) {
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
  return {buffer, end};
}

// Writes one JSON value. The writer sets the commas. Numbers that JSON does not know become null, and bytes that are
// no UTF-8 U+FFFD.
class JsonWriter {
 public:
  JsonWriter& begin_object() { return open('{'); }
  JsonWriter& end_object() { return close('}'); }
  JsonWriter& begin_array() { return open('['); }
  JsonWriter& end_array() { return close(']'); }
  JsonWriter& key(std::string_view name) {
    value(name);
    text_ += ':';
    return *this;
  }
  JsonWriter& member(std::string_view name, const auto& member_value) { return key(name).value(member_value); }

  JsonWriter& value(bool flag) { return put(flag ? "true" : "false"); }
  JsonWriter& value(std::integral auto number) { return put(std::to_string(number)); }
  JsonWriter& value(std::floating_point auto number) {
    return put(std::isfinite(number) ? number_text(number) : "null");
  }
  JsonWriter& value(const char* text) { return value(std::string_view{text}); }
  JsonWriter& value(const std::string& text) { return value(std::string_view{text}); }
  JsonWriter& value(std::string_view text) {
    separate();
    text_ += '"';
    while (!text.empty()) {
      const std::size_t size = letter_size(text);
      if (size == 1) escape(text.front());
      else text_ += size == 0 ? std::string_view{"\\ufffd"} : text.substr(0, size);
      text.remove_prefix(std::max<std::size_t>(size, 1));
    }
    text_ += '"';
    return *this;
  }
  JsonWriter& values(const auto& all) {
    begin_array();
    for (const auto& each : all) value(each);
    return end_array();
  }
  const std::string& text() const { return text_; }
  void clear() { text_.clear(); }

 private:
  JsonWriter& open(char bracket) {
    separate();
    text_ += bracket;
    return *this;
  }
  JsonWriter& close(char bracket) {
    text_ += bracket;
    return *this;
  }
  JsonWriter& put(std::string_view text) {
    separate();
    text_ += text;
    return *this;
  }
  void separate() {
    if (!text_.empty() && std::string_view{"{[:"}.find(text_.back()) == std::string_view::npos) text_ += ',';
  }
  void escape(char character) {
    static constexpr char digits[] = "0123456789abcdef";
    const auto code = static_cast<unsigned char>(character);
    if (character == '"' || character == '\\') {
      text_ += '\\';
      text_ += character;
    } else if (code < 0x20) {
      text_ += "\\u00";
      text_ += digits[code >> 4];
      text_ += digits[code & 15];
    } else {
      text_ += character;
    }
  }

  std::string text_;
};

}
