// A loop in which document code draws, as it tells an enumerator of its rounds: see enumerator.hpp.
//
// Emitted code puts `DrawingLoop aos_loop{AOS, number};` before the loop, and `aos_loop.head(...)` before each test of its
// condition. The way into the loop decides on everything that the loop does not change. What it may change is told
// value by value: all local variables that the text sees there, the results of the section, and the copies of the state.
#pragma once

#include "aos/draws/loop_heads.hpp"
#include "aos/model/blame.hpp"
#include "aos/model/endless_steps.hpp"
#include "aos/model/reflection.hpp"

namespace aos {

namespace detail {

template <class T>
inline constexpr bool is_tuple = false;
template <class... Parts>
inline constexpr bool is_tuple<std::tuple<Parts...>> = true;
template <class First, class Second>
inline constexpr bool is_tuple<std::pair<First, Second>> = true;

// Whether equal bytes, as `write_key` writes them, are equal values. With `pointers`, a pointer is told by its place: what
// it points to is told as a variable of its own.
template <class T, bool pointers>
consteval bool can_be_told() {
  if constexpr (std::is_array_v<T>) {
    return can_be_told<std::remove_cv_t<std::remove_extent_t<T>>, pointers>();
  } else if constexpr (Listed<T>) {
    return std::is_trivially_copyable_v<T>;
  } else if constexpr (std::is_pointer_v<T>) {
    return pointers;
  } else if constexpr (Compound<T> || std::is_arithmetic_v<T> || std::is_enum_v<T> || std::same_as<T, std::string> ||
                       std::same_as<T, Text> || Mapping<T>) {
    return true;
  } else if constexpr (is_tuple<T>) {
    return []<std::size_t... I>(std::index_sequence<I...>) {
      return (can_be_told<std::remove_cv_t<std::tuple_element_t<I, T>>, pointers>() && ...);
    }(std::make_index_sequence<std::tuple_size_v<T>>{});
  } else if constexpr (Sequence<T>) {
    return can_be_told<std::remove_cv_t<typename T::value_type>, pointers>();
  } else {
    return false;
  }
}

inline void write_bytes(std::string& key, const void* bytes, std::size_t size) {
  key.append(static_cast<const char*>(bytes), size);
}

// Appends a value. No value's bytes are the beginning of another's of the same type.
template <class T>
void write_key(std::string& key, const T& value) {
  if constexpr (Listed<T>) {
    write_bytes(key, &value, sizeof value);
  } else if constexpr (std::is_array_v<T>) {
    for (const auto& element : value) write_key(key, element);
  } else if constexpr (Compound<T>) {
    T::aos_fields(value, [&](const char*, const auto& member) { write_key(key, member); });
  } else if constexpr (is_tuple<T>) {
    std::apply([&](const auto&... part) { (write_key(key, part), ...); }, value);
  } else if constexpr (Mapping<T>) {
    write_key(key, static_cast<std::uint64_t>(std::distance(value.begin(), value.end())));
    for (const auto& [name, element] : value) {
      write_key(key, name);
      write_key(key, element);
    }
  } else if constexpr (std::same_as<T, std::string> || std::same_as<T, Text>) {
    write_key(key, static_cast<std::uint64_t>(value.size()));
    write_bytes(key, value.c_str(), value.size());
  } else if constexpr (Sequence<T>) {
    write_key(key, static_cast<std::uint64_t>(value.size()));
    for (const typename T::value_type& element : value) write_key(key, element);
  } else if constexpr (std::is_same_v<T, long double>) {
    write_key(key, static_cast<double>(value));
    write_key(key, static_cast<double>(value - static_cast<double>(value)));
  } else {
    write_bytes(key, &value, sizeof value);
  }
}

}  // namespace detail

template <class Source>
class DrawingLoop {
 public:
  DrawingLoop(Source& source, std::uint32_t number) : heads_(source.loop_heads()), number_(number) {
    if (heads_ != nullptr) [[unlikely]] entry_ = heads_->enter();
  }

  // `mentioned` are the variables that the loop's text names, `others` those that it sees besides. Where a mentioned
  // variable cannot be told, no path is cut at this loop.
  template <class... Mentioned, class... Others>
  void head(const std::tuple<Mentioned&...>& mentioned, const std::tuple<Others&...>& others) {
    tell<true>(mentioned, others);
  }
  // The same in a lambda or a function, where a pointer may point to what the loop does not see.
  template <class... Mentioned, class... Others>
  void head_in_function(const std::tuple<Mentioned&...>& mentioned, const std::tuple<Others&...>& others) {
    tell<false>(mentioned, others);
  }

 private:
  template <bool pointers, class... Mentioned, class... Others>
  void tell(const std::tuple<Mentioned&...>& mentioned, const std::tuple<Others&...>& others) {
    if constexpr ((detail::can_be_told<std::remove_cv_t<Mentioned>, pointers>() && ...)) {
      if (heads_ == nullptr) [[likely]] {
        if (++rounds_ > allowed_rounds) [[unlikely]] look_whether_it_ends(number_, rounds_);
        return;
      }
      std::string* const key = heads_->arrive(number_, entry_);
      if (key == nullptr) return;
      const auto write = [&]<class T>(const T& value) {
        if constexpr (detail::can_be_told<std::remove_cv_t<T>, pointers>()) detail::write_key(*key, value);
      };
      std::apply([&](const auto&... value) { (write(value), ...); }, mentioned);
      std::apply([&](const auto&... value) { (write(value), ...); }, others);
      blame::over();
      heads_->cut();
    }
  }

  LoopHeads* heads_;
  std::uint32_t number_;
  std::uint32_t entry_ = 0;
  std::uint32_t rounds_ = 0;
};

}  // namespace aos
