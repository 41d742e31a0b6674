// Values for code that does not know their types. A visitor sees the members and the leaves of a value one by
// one. Emitted code lists the members of compounds and states in `aos_fields` and gives enums a `name_of`.
//
// Each type has one small visiting function. What is made of the leaves (text, JSON, addresses) is compiled once, with
// the engine: values.hpp, value_text.hpp. The variables of a state, which may be thousands, are data: see Member.
#pragma once

#include <bit>
#include <concepts>
#include <span>
#include <tuple>

#include "aos/base/mixed.hpp"
#include "aos/model/text.hpp"

namespace aos {

class JsonWriter;

// A part of a state.
struct ByteRange {
  std::size_t offset;
  std::size_t size;
};

template <class T>
concept Compound = requires(const T& value) { T::aos_fields(value, [](const char*, const auto&) {}); };
template <class T>
concept Listed = requires { T::aos_members(); };
template <class T>
concept Sequence = requires(const T& value) {
  typename T::value_type;
  value.size();
  value.begin();
} && !std::same_as<T, Text> && !std::same_as<T, std::string>;
// An array over an enum. Its elements have the names of the enum's values.
template <class T>
concept Enumerated = requires { typename T::index_enum; };
template <class T>
concept Mapping = requires { typename T::mapped_type; };

// The name of an enum's value; null if the value has none.
inline const char* name_in(std::initializer_list<const char*> names, int value) {
  const auto index = static_cast<std::size_t>(value);
  return index < names.size() ? names.begin()[index] : nullptr;
}

// A leaf: a single value and its address.
struct Leaf {
  enum class Kind : std::uint8_t { boolean, signed_number, unsigned_number, real, enumerated, text, string };
  Kind kind;
  std::size_t size;
  const void* place;
  const char* name = nullptr;  // of an enum's value, or null
};

template <class T>
constexpr Leaf::Kind leaf_kind() {
  using Kind = Leaf::Kind;
  constexpr Kind kind = std::is_enum_v<T>              ? Kind::enumerated
                        : std::same_as<T, bool>        ? Kind::boolean
                        : std::same_as<T, Text>        ? Kind::text
                        : std::same_as<T, std::string> ? Kind::string
                        : std::floating_point<T>       ? Kind::real
                        : std::is_signed_v<T>          ? Kind::signed_number
                                                       : Kind::unsigned_number;
  static_assert(kind != Kind::unsigned_number || std::integral<T>);
  return kind;
}

template <class T>
Leaf leaf_of(const T& value) {
  Leaf leaf{leaf_kind<T>(), sizeof value, &value};
  if constexpr (requires { name_of(value); }) leaf.name = name_of(value);
  return leaf;
}

// The text of a leaf: enums by name, `true` and `false`, the shortest decimal that reads back.
std::string leaf_text(const Leaf& leaf);

template <class Key>
std::string key_text(const Key& key) {
  std::string text;
  const auto add = [&](const Leaf& part) {
    if (!text.empty()) text += ',';
    text += leaf_text(part);
  };
  std::apply([&](const auto&... part) { (add(leaf_of(part)), ...); }, key);
  return text;
}

// Is told the parts of a value in the order of its members. The name or the index of a part comes before its value.
class ValueVisitor {
 public:
  virtual void leaf(const Leaf& leaf) = 0;
  virtual void begin_compound() {}
  virtual void begin_sequence(std::size_t /*size*/) {}
  virtual void begin_mapping() {}
  virtual void member(const char* /*name*/) {}
  virtual void element(std::size_t /*index*/) {}
  virtual void entry(const std::string& /*key*/) {}
  virtual void end() {}  // of a compound, a sequence or a mapping

 protected:
  ~ValueVisitor() = default;
};

class StateReader;

// A variable of a state: its name, its place, and what can be done with its type.
struct Member {
  const char* name;
  std::size_t offset;    // within the state
  const void* constant;  // the variable itself where no state holds it
  void (*visit)(const void* variable, ValueVisitor& visitor);
  void (*read)(void* variable, StateReader& text);
};

void visit_members(const void* state, std::span<const Member> members, ValueVisitor& visitor);

template <class T>
void visit_value(const T& value, ValueVisitor& visitor) {
  if constexpr (Listed<T>) {
    visit_members(&value, T::aos_members(), visitor);
  } else if constexpr (Compound<T>) {
    visitor.begin_compound();
    T::aos_fields(value, [&](const char* name, const auto& member) {
      visitor.member(name);
      visit_value(member, visitor);
    });
    visitor.end();
  } else if constexpr (Mapping<T>) {
    visitor.begin_mapping();
    for (const auto& [key, element] : value) {
      visitor.entry(key_text(key));
      visit_value(element, visitor);
    }
    visitor.end();
  } else if constexpr (Enumerated<T>) {
    visitor.begin_mapping();
    int index = 0;
    for (const auto& element : value) {
      visitor.entry(name_of(static_cast<typename T::index_enum>(index++)));
      visit_value(element, visitor);
    }
    visitor.end();
  } else if constexpr (Sequence<T>) {
    visitor.begin_sequence(value.size());
    std::size_t index = 0;
    for (const auto& element : value) {
      visitor.element(index++);
      visit_value(element, visitor);
    }
    visitor.end();
  } else {
    visitor.leaf(leaf_of(value));
  }
}

// Refers to a value of any type, which must outlive it.
class AnyValue {
 public:
  template <class T>
  AnyValue(const T& value) : value_(&value), visit_(visit_as<T>) {}
  AnyValue(const void* value, void (*visit)(const void*, ValueVisitor&)) : value_(value), visit_(visit) {}
  void visit(ValueVisitor& visitor) const { visit_(value_, visitor); }
  const void* place() const { return value_; }

 private:
  template <class T>
  static void visit_as(const void* value, ValueVisitor& visitor) {
    visit_value(*static_cast<const T*>(value), visitor);
  }

  const void* value_;
  void (*visit_)(const void* value, ValueVisitor& visitor);
};

// All leaves with their names, as one line.
std::string leaves_text(AnyValue value);
// The leaves of some members, as `name.member=value`; of all where none is named. A long text is cut.
std::string leaves_text(const char* name, AnyValue value, std::initializer_list<std::string_view> members);
// The text of a whole value, for the names of grounded actions.
std::string value_text(AnyValue value);
void write_json(JsonWriter& json, AnyValue value);

// Document code writes enums to streams as numbers. Without this, the small enums of a state would print as characters.
template <class Stream, class Enum>
  requires std::is_enum_v<Enum> && requires { typename Stream::char_type; }
Stream& operator<<(Stream& out, Enum value) { return static_cast<Stream&>(out << static_cast<int>(value)); }

// Extends a hash by `size` bytes. It is not inlined, since a state may have many arrays.
[[gnu::noinline]] inline std::uint64_t hashed_bytes(std::uint64_t hash, const void* bytes, std::size_t size) {
  const auto* next = static_cast<const char*>(bytes);
  std::uint64_t word = 0;
  for (; size >= sizeof word; size -= sizeof word, next += sizeof word) {
    std::memcpy(&word, next, sizeof word);
    hash = mixed(hash, word);
  }
  word = 0;
  std::memcpy(&word, next, size);
  return size > 0 ? mixed(hash, word) : hash;
}

// A sequence without gaps whose values are equal exactly if their bytes are.
template <class T>
concept PlainSequence = Sequence<T> && requires(const T& value) { value.data(); } &&
                        std::has_unique_object_representations_v<typename T::value_type>;

// Extends a hash so that equal values get equal hashes: 0.0 and -0.0 are one, unused storage does not count.
template <class T>
std::uint64_t hashed(std::uint64_t hash, const T& value) {
  if constexpr (PlainSequence<T>) {
    return hashed_bytes(mixed(hash, value.size()), value.data(), value.size() * sizeof(typename T::value_type));
  } else if constexpr (Compound<T>) {
    T::aos_fields(value, [&](const char*, const auto& member) { hash = hashed(hash, member); });
    return hash;
  } else if constexpr (Mapping<T>) {
    for (const auto& entry : value) hash = hashed(hash, entry.second);
    return hash;
  } else if constexpr (std::same_as<T, Text> || Sequence<T>) {
    hash = mixed(hash, value.size());
    for (const auto& element : value) hash = hashed(hash, element);
    return hash;
  } else if constexpr (std::floating_point<T>) {
    return mixed(hash, std::bit_cast<std::uint64_t>(static_cast<double>(value == 0 ? 0.0 : value)));
  } else {
    return mixed(hash, static_cast<std::uint64_t>(value));
  }
}

}
