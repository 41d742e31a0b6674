// Values as text, as JSON, and as the numbers of a saved state. Only support.hpp includes this file.
#pragma once

#include "aos/base/fault.hpp"
#include "aos/model/reflection.hpp"
#include "aos/model/state_text.hpp"
#include "aos/model/values.hpp"
#include "aos/text/json.hpp"

namespace aos {

std::string leaf_text(const Leaf& leaf) {
  if (leaf.name != nullptr) return leaf.name;
  if (is_text(leaf)) return std::string{characters_of(leaf)};
  if (leaf.kind == Leaf::Kind::boolean) return stored_at<bool>(leaf.place) ? "true" : "false";
  std::string text;
  with_number(leaf, [&](auto number) { text = number_text(number); });
  return text;
}

std::string leaves_text(AnyValue value) {
  std::string text;
  NamedLeaves leaves{
      [&](const std::string& name, const Leaf& leaf) { text += (text.empty() ? "" : ", ") + name + "=" + leaf_text(leaf); }};
  value.visit(leaves);
  return text;
}

std::string leaves_text(const char* owner, AnyValue value, std::initializer_list<std::string_view> members) {
  constexpr std::size_t longest = 300;
  std::string text;
  NamedLeaves leaves{[&](const std::string& name, const Leaf& leaf) {
    const std::string_view member = std::string_view{name}.substr(0, name.find_first_of(".["));
    if (members.size() > 0 && std::find(members.begin(), members.end(), member) == members.end()) return;
    if (text.size() <= longest) text += (text.empty() ? "" : ", ") + (owner + ("." + name)) + "=" + leaf_text(leaf);
  }};
  value.visit(leaves);
  return text.size() <= longest ? text : text.substr(0, longest) + " ...";
}

void visit_members(const void* state, std::span<const Member> members, ValueVisitor& visitor) {
  visitor.begin_compound();
  for (const Member& member : members) {
    visitor.member(member.name);
    member.visit(static_cast<const std::byte*>(state) + member.offset, visitor);
  }
  visitor.end();
}

// Writes compounds as `{x=1, y=2}` and sequences as `[1, 2]`.
class ValueText final : public ValueVisitor {
 public:
  void leaf(const Leaf& leaf) override { text_ += leaf_text(leaf); }
  void begin_compound() override { begin('{', '}'); }
  void begin_sequence(std::size_t) override { begin('[', ']'); }
  void begin_mapping() override { begin('[', ']'); }
  void member(const char* name) override { (separate() += name) += '='; }
  void element(std::size_t) override { separate(); }
  void entry(const std::string& key) override { (separate() += key) += '='; }
  void end() override {
    text_ += ends_.back();
    ends_.pop_back();
  }
  std::string& text() { return text_; }

 private:
  void begin(char bracket, char end) {
    text_ += bracket;
    ends_ += end;
    is_first_ = true;
  }
  std::string& separate() {
    if (!std::exchange(is_first_, false)) text_ += ", ";
    return text_;
  }

  std::string text_;
  std::string ends_;
  bool is_first_ = true;
};

std::string value_text(AnyValue value) {
  ValueText visitor;
  value.visit(visitor);
  return std::move(visitor.text());
}

class ValueJson final : public ValueVisitor {
 public:
  explicit ValueJson(JsonWriter& json) : json_(json) {}
  void leaf(const Leaf& leaf) override {
    if (leaf.kind == Leaf::Kind::boolean) {
      json_.value(stored_at<bool>(leaf.place));
    } else if (leaf.kind == Leaf::Kind::enumerated || is_text(leaf)) {
      json_.value(leaf_text(leaf));
    } else {
      with_number(leaf, [&](auto number) { json_.value(number); });
    }
  }
  void begin_compound() override { begin_object(); }
  void begin_mapping() override { begin_object(); }
  void begin_sequence(std::size_t) override {
    json_.begin_array();
    are_arrays_.push_back(true);
  }
  void member(const char* name) override { json_.key(name); }
  void entry(const std::string& key) override { json_.key(key); }
  void end() override {
    are_arrays_.back() ? json_.end_array() : json_.end_object();
    are_arrays_.pop_back();
  }

 private:
  void begin_object() {
    json_.begin_object();
    are_arrays_.push_back(false);
  }

  JsonWriter& json_;
  std::vector<bool> are_arrays_;
};

void write_json(JsonWriter& json, AnyValue value) {
  ValueJson visitor{json};
  value.visit(visitor);
}

// Writes numbers with blanks between them.
class ValueNumbers final : public ValueVisitor {
 public:
  explicit ValueNumbers(std::string& text) : text_(text) {}
  void begin_sequence(std::size_t size) override { put(static_cast<std::int64_t>(size)); }
  void leaf(const Leaf& leaf) override {
    if (is_text(leaf)) {
      const std::string_view characters = characters_of(leaf);
      put(static_cast<std::int64_t>(characters.size()));
      for (const char character : characters) put(character);
    } else {
      put(static_cast<std::int64_t>(leaf_number(leaf)));
    }
  }

 private:
  void put(std::int64_t number) {
    char buffer[24];
    if (!text_.empty()) text_ += ' ';
    text_.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr);
  }

  std::string& text_;
};

void StateWriter::write(AnyValue value) {
  ValueNumbers visitor{text_};
  value.visit(visitor);
}

void StateReader::read_leaf(Leaf::Kind kind, std::size_t size, void* place) {
  const auto store = [place](auto value) { std::memcpy(place, &value, sizeof value); };
  if (kind == Leaf::Kind::text) {
    *static_cast<Text*>(place) = next_characters();
  } else if (kind == Leaf::Kind::string) {
    *static_cast<std::string*>(place) = next_characters();
  } else if (kind == Leaf::Kind::real) {
    const auto number = std::bit_cast<double>(next());
    size == sizeof(float) ? store(static_cast<float>(number)) : store(number);
  } else if (kind == Leaf::Kind::boolean) {
    store(next() != 0);
  } else if (size == 1) {
    store(static_cast<std::int8_t>(next()));
  } else if (size == 2) {
    store(static_cast<std::int16_t>(next()));
  } else if (size == 4) {
    store(static_cast<std::int32_t>(next()));
  } else {
    store(next());
  }
}

std::string StateReader::next_characters() {
  std::string characters;
  for (std::int64_t left = next(); left > 0; --left) characters += static_cast<char>(next());
  return characters;
}

void StateReader::malformed() { throw ModelFault{"AOS215", "a saved state that does not fit this model"}; }

std::int64_t StateReader::next() {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
  if (error != std::errc{}) malformed();
  rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
  if (!rest_.empty()) rest_.remove_prefix(1);
  return number;
}

void NamedTexts::add(std::string_view name, std::string_view text) { texts_.emplace_back(name, text); }

const std::string* NamedTexts::find(std::string_view name) const {
  const auto known = std::ranges::find(texts_, name, &std::pair<std::string, std::string>::first);
  return known != texts_.end() ? &known->second : nullptr;
}

void SavedConstants::add_all(std::span<const Member> members) {
  for (const Member& member : members) {
    if (member.constant == nullptr) continue;
    StateWriter text;
    text.write(AnyValue{member.constant, member.visit});
    add(member.name, text.text());
  }
}

void SavedConstants::read(const Member& member, void* state, StateReader& text) const {
  const bool is_constant = member.constant != nullptr;
  void* const variable = is_constant ? const_cast<void*>(member.constant) : static_cast<std::byte*>(state) + member.offset;
  const std::string* const known = find(member.name);
  if (known == nullptr) return member.read(variable, text);
  if (is_constant) return;
  StateReader value{*known};
  member.read(variable, value);
  value.finish();
}

void SavedConstants::read_all(std::span<const Member> members, void* state, StateReader& text) const {
  for (const Member& member : members) read(member, state, text);
}

}
