// A command to the engine, as one line of parts between tabs. The parts are the command's name and its fields
// as `name=value`. A command that takes a list has an empty part and then the items. The order of fields does
// not matter, and unused ones are ignored. A missing or malformed field is a BadCommand. Within a part \t, \n and \\ are
// a tab, a line end and a backslash.
// aos_solver/child/lines/command_line.py writes the lines.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include "aos/base/list.hpp"

namespace aos {

// Thrown for a command that cannot be carried out as it was given.
struct BadCommand {
  std::string text;
};

namespace detail {

inline List<std::string_view> parts_of(std::string_view line, char separator) {
  List<std::string_view> parts;
  for (;;) {
    const auto end = line.find(separator);
    parts.push_back(line.substr(0, end));
    if (end == std::string_view::npos) return parts;
    line.remove_prefix(end + 1);
  }
}

template <class Number>
Number number_in(std::string_view text) {
  Number number{};
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc{} || read.ptr != text.data() + text.size()) {
    throw BadCommand{"not a number: " + std::string{text}};
  }
  return number;
}

}  // namespace detail

class Command {
 public:
  explicit Command(std::string line) : line_{std::move(line)} {
    auto parts = detail::parts_of(line_, '\t');
    for (auto& part : parts) part = unescaped(part);
    name_ = parts[0];
    auto part = parts.begin() + 1;
    for (; part != parts.end() && !part->empty(); ++part) {
      const auto equals = part->find('=');
      if (equals == std::string_view::npos) throw BadCommand{"a field without a name: " + std::string{*part}};
      fields_.push_back({part->substr(0, equals), part->substr(equals + 1)});
    }
    if (part != parts.end()) items_.assign(part + 1, parts.end());
  }

  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  std::string_view name() const { return name_; }
  const List<std::string_view>& items() const { return items_; }

  std::optional<std::string_view> optional_text(std::string_view field) const {
    const auto found = std::ranges::find(fields_, field, &Field::name);
    return found != fields_.end() ? std::optional{found->value} : std::nullopt;
  }
  std::string_view text(std::string_view field) const {
    const auto found = optional_text(field);
    if (!found) throw BadCommand{std::string{name_} + " has no field " + std::string{field}};
    return *found;
  }
  template <class Number>
  Number number(std::string_view field) const { return detail::number_in<Number>(text(field)); }
  bool flag(std::string_view field) const { return number<int>(field) != 0; }

 private:
  struct Field {
    std::string_view name;
    std::string_view value;
  };

  // In the place of the part, as it only becomes shorter.
  std::string_view unescaped(std::string_view part) {
    if (part.find('\\') == std::string_view::npos) return part;
    char* const begin = line_.data() + (part.data() - line_.data());
    char* end = begin;
    for (std::size_t at = 0; at < part.size(); ++at) {
      const bool is_escape = part[at] == '\\' && at + 1 < part.size();
      const char letter = is_escape ? part[++at] : part[at];
      *end++ = !is_escape ? letter : letter == 't' ? '\t' : letter == 'n' ? '\n' : letter;
    }
    return {begin, end};
  }

  std::string line_;
  std::string_view name_;
  List<Field> fields_;
  List<std::string_view> items_;
};

}  // namespace aos
