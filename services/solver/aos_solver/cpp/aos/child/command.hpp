// A command to the engine, as one line of parts between tabs. The parts are the command's name and its fields
// as `name=value`. A command that takes a list has an empty part and then the items. The order of fields does
// not matter, and unused ones are ignored. A missing or malformed field is a BadCommand.
// aos_solver/child/lines/command_line.py writes the lines.
#pragma once

#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aos {

// Thrown for a command that cannot be carried out as it was given.
struct BadCommand {
  std::string text;
};

namespace detail {

inline std::vector<std::string_view> parts_of(std::string_view line, char separator) {
  std::vector<std::string_view> parts;
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
  explicit Command(std::string_view line) {
    const auto parts = detail::parts_of(line, '\t');
    name_ = parts[0];
    auto part = parts.begin() + 1;
    for (; part != parts.end() && !part->empty(); ++part) {
      const auto equals = part->find('=');
      if (equals == std::string_view::npos) throw BadCommand{"a field without a name: " + std::string{*part}};
      fields_.push_back({part->substr(0, equals), part->substr(equals + 1)});
    }
    if (part != parts.end()) items_.assign(part + 1, parts.end());
  }

  std::string_view name() const { return name_; }
  const std::vector<std::string_view>& items() const { return items_; }

  std::optional<std::string_view> optional_text(std::string_view field) const {
    for (const Field& each : fields_) {
      if (each.name == field) return each.value;
    }
    return std::nullopt;
  }
  std::string_view text(std::string_view field) const {
    const auto found = optional_text(field);
    if (!found) throw BadCommand{std::string{name_} + " has no field " + std::string{field}};
    return *found;
  }
  template <class Number>
  Number number(std::string_view field) const {
    return detail::number_in<Number>(text(field));
  }
  bool flag(std::string_view field) const { return number<int>(field) != 0; }

 private:
  struct Field {
    std::string_view name;
    std::string_view value;
  };

  std::string_view name_;
  std::vector<Field> fields_;
  std::vector<std::string_view> items_;
};

}  // namespace aos
