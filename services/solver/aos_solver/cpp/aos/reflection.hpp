// Walks over a state: its leaves by name, its hash, its JSON. Compounds and states list their members in `__fields`,
// enums have a `name_of`, both emitted.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "aos/json.hpp"
#include "aos/text.hpp"

namespace aos {

template <class T>
concept Compound = requires(const T& value) { T::__fields(value, [](const char*, const auto&) {}); };
template <class T>
concept Sequence = requires(const T& value) {
  typename T::value_type;
  value.size();
  value.begin();
} && !std::same_as<T, Text> && !std::same_as<T, std::string>;
template <class T>
concept Mapping = requires { typename T::mapped_type; };

// The name of an enum's value; null for a number that has none.
template <class E>
const char* name_in(std::initializer_list<const char*> names, E value) {
  const auto index = static_cast<std::size_t>(value);
  return index < names.size() ? names.begin()[index] : nullptr;
}

// The text of a single value: enums by name, `true` and `false`, the shortest decimal that reads back.
template <class T>
std::string leaf_text(const T& leaf) {
  if constexpr (std::same_as<T, bool>) {
    return leaf ? "true" : "false";
  } else if constexpr (std::same_as<T, Text> || std::same_as<T, std::string>) {
    return leaf;
  } else if constexpr (std::is_enum_v<T>) {
    const char* name = name_of(leaf);
    return name ? name : std::to_string(static_cast<long long>(leaf));
  } else if constexpr (std::floating_point<T>) {
    return number_text(leaf);
  } else {
    return std::to_string(leaf);
  }
}

// Document code writes enums to streams as numbers. Those of a state are as small as characters, and are none.
template <class Stream, class Enum>
  requires std::is_enum_v<Enum> && requires { typename Stream::char_type; }
Stream& operator<<(Stream& out, Enum value) {
  return static_cast<Stream&>(out << static_cast<int>(value));
}

template <class Key>
std::string key_text(const Key& key) {
  std::string text;
  std::apply([&](const auto&... part) { ((text += text.empty() ? leaf_text(part) : "," + leaf_text(part)), ...); }, key);
  return text;
}

// Calls `visit(name, leaf)` for every single value in `value`: `v1.visited`, `grid[3]`, `cell[1,2]`.
template <class T, class Visit>
void visit_leaves(const std::string& name, const T& value, Visit&& visit) {
  if constexpr (Compound<T>) {
    T::__fields(value, [&](const char* field, const auto& member) {
      visit_leaves(name.empty() ? field : name + "." + field, member, visit);
    });
  } else if constexpr (Mapping<T>) {
    for (const auto& [key, element] : value) visit_leaves(name + "[" + key_text(key) + "]", element, visit);
  } else if constexpr (Sequence<T>) {
    int index = 0;
    for (const auto& element : value) visit_leaves(name + "[" + std::to_string(index++) + "]", element, visit);
  } else {
    visit(name, value);
  }
}

// All leaves of a state with their names, as one line.
template <class State>
std::string leaves_text(const State& state) {
  std::string text;
  visit_leaves("", state, [&](const std::string& name, const auto& leaf) {
    text += (text.empty() ? "" : ", ") + name + "=" + leaf_text(leaf);
  });
  return text;
}

// Where in a state something stands that has a meaning of its own: a single value, or the members of one compound.
struct Place {
  std::size_t offset;
  std::size_t size;
  friend bool operator==(const Place&, const Place&) = default;
};

// The places of a state, without overlap.
template <class State>
std::vector<Place> places_in(const State& state) {
  std::vector<Place> places;
  std::string compound;
  visit_leaves("", state, [&](const std::string& name, const auto& leaf) {
    const auto offset = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(std::addressof(leaf)) -
                                                 reinterpret_cast<const std::byte*>(std::addressof(state)));
    const auto dot = name.rfind('.');
    const std::string owner = dot == std::string::npos ? "" : name.substr(0, dot);
    if (!owner.empty() && owner == compound) {
      places.back().size = offset + sizeof leaf - places.back().offset;
    } else {
      places.push_back({offset, sizeof leaf});
    }
    compound = owner;
  });
  return places;
}

// Text of a whole value, for the names of grounded actions.
template <class T>
std::string value_text(const T& value) {
  if constexpr (Compound<T>) {
    std::string text;
    T::__fields(value, [&](const char* field, const auto& member) {
      text += (text.empty() ? "{" : ", ") + std::string{field} + "=" + value_text(member);
    });
    return text + "}";
  } else if constexpr (Sequence<T>) {
    std::string text;
    for (const auto& element : value) text += (text.empty() ? "[" : ", ") + value_text(element);
    return text.empty() ? "[]" : text + "]";
  } else {
    return leaf_text(value);
  }
}

template <class T>
void write_json(JsonWriter& json, const T& value) {
  if constexpr (Compound<T>) {
    json.begin_object();
    T::__fields(value, [&](const char* field, const auto& member) { write_json(json.key(field), member); });
    json.end_object();
  } else if constexpr (Sequence<T>) {
    json.begin_array();
    for (const auto& element : value) write_json(json, element);
    json.end_array();
  } else if constexpr (std::same_as<T, Text>) {
    json.value(value.view());
  } else if constexpr (std::is_enum_v<T>) {
    json.value(leaf_text(value));
  } else {
    json.value(value);
  }
}

inline std::uint64_t mixed(std::uint64_t hash, std::uint64_t more) {
  hash = (hash ^ more) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 32);
}

// A hash that agrees with `==`: 0.0 and -0.0 are one, unused storage does not count.
template <class T>
std::uint64_t hashed(std::uint64_t hash, const T& value) {
  if constexpr (Compound<T>) {
    T::__fields(value, [&](const char*, const auto& member) { hash = hashed(hash, member); });
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

}  // namespace aos
