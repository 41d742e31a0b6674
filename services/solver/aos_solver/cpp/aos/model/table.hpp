// Maps over finite sets of keys, stored in place. They are the state variables with parameters.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>

#include "aos/base/fault.hpp"

namespace aos {

// An axis of a Table: the integers from `First` in steps of `Stride` up to, not including, `Stop`.
template <int First, int Stop, int Stride>
struct RangeAxis {
  using Key = int;
  static constexpr int size = Stop > First ? (Stop - First + Stride - 1) / Stride : 0;
  static constexpr Key key(int index) { return First + index * Stride; }
  static constexpr int index(Key key) {
    const int offset = key - First;
    return offset >= 0 && offset % Stride == 0 && offset / Stride < size ? offset / Stride : -1;
  }
};

// An axis of a Table: all values of an enum, numbered from 0.
template <class E, int Size>
struct EnumAxis {
  using Key = E;
  static constexpr int size = Size;
  static constexpr Key key(int index) { return static_cast<E>(index); }
  static constexpr int index(Key key) {
    const int value = static_cast<int>(key);
    return value >= 0 && value < size ? value : -1;
  }
};

// An element of a Table as std::map shows it. An iterator gives an entry that refers into the table. A copy
// of the entry has its own value, as a copied std::pair has.
template <class Key, class T>
class TableEntry {
 public:
  const Key first;
  T& second;

  TableEntry(const Key& key, T& value) : first(key), second(value) {}
  TableEntry(const TableEntry& other) : first(other.first), second(own_), own_(other.second) {}
  TableEntry& operator=(const TableEntry&) = delete;

  template <std::size_t Index>
  auto& get() const {
    if constexpr (Index == 0) {
      return first;
    } else {
      return second;
    }
  }

 private:
  std::remove_const_t<T> own_{};
};

template <class Table, class T>
class TableIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = TableEntry<typename Table::key_type, T>;
  using difference_type = std::ptrdiff_t;
  using pointer = value_type*;
  using reference = value_type&;

  TableIterator(T* values, int index) : values_(values), index_(index) {}
  reference operator*() const { return entry_.emplace(Table::key(index_), values_[index_]); }
  pointer operator->() const { return &**this; }
  TableIterator& operator++() {
    ++index_;
    return *this;
  }
  TableIterator operator++(int) { return {values_, index_++}; }
  friend bool operator==(const TableIterator& left, const TableIterator& right) { return left.index_ == right.index_; }

  TableIterator(const TableIterator& other) : values_(other.values_), index_(other.index_) {}
  TableIterator& operator=(const TableIterator& other) {
    values_ = other.values_;
    index_ = other.index_;
    return *this;
  }

 private:
  T* values_;
  int index_;
  mutable std::optional<value_type> entry_;
};

// A T for every tuple of keys, with the reading and assigning part of std::map's interface. Elements are
// neither added nor removed. A key outside of the axes is a ModelFault.
template <class T, class... Axes>
class Table {
 public:
  using key_type = std::tuple<typename Axes::Key...>;
  using mapped_type = T;
  using iterator = TableIterator<Table, T>;
  using const_iterator = TableIterator<Table, const T>;
  static constexpr int capacity = (1 * ... * Axes::size);

  T& operator[](const key_type& key) { return values_[checked(key)]; }
  const T& operator[](const key_type& key) const { return values_[checked(key)]; }
  T& at(const key_type& key) { return (*this)[key]; }
  const T& at(const key_type& key) const { return (*this)[key]; }
  iterator find(const key_type& key) { return {values_, position(key)}; }
  const_iterator find(const key_type& key) const { return {values_, position(key)}; }
  std::size_t count(const key_type& key) const { return contains(key) ? 1 : 0; }
  bool contains(const key_type& key) const { return position(key) != capacity; }

  static constexpr std::size_t size() { return capacity; }
  static constexpr bool empty() { return capacity == 0; }
  iterator begin() { return {values_, 0}; }
  iterator end() { return {values_, capacity}; }
  const_iterator begin() const { return {values_, 0}; }
  const_iterator end() const { return {values_, capacity}; }
  const_iterator cbegin() const { return begin(); }
  const_iterator cend() const { return end(); }

  bool operator==(const Table&) const = default;

  // The keys of the element at a position; the last axis runs fastest.
  static key_type key(int position) {
    constexpr std::array<int, sizeof...(Axes)> sizes{Axes::size...};
    std::array<int, sizeof...(Axes)> indices{};
    for (std::size_t axis = sizes.size(); axis-- > 0; position /= sizes[axis]) indices[axis] = position % sizes[axis];
    return key(indices, std::index_sequence_for<Axes...>{});
  }

 private:
  template <std::size_t... Index>
  static key_type key(const std::array<int, sizeof...(Axes)>& indices, std::index_sequence<Index...>) {
    return key_type{Axes::key(indices[Index])...};
  }
  // The position of a key, or `capacity` if there is no such key.
  static int position(const key_type& key) { return position(key, std::index_sequence_for<Axes...>{}); }
  template <std::size_t... Index>
  static int position(const key_type& key, std::index_sequence<Index...>) {
    int position = 0;
    bool is_known = true;
    const auto step = [&](int size, int index) {
      is_known = is_known && index >= 0;
      position = position * size + index;
    };
    (step(Axes::size, Axes::index(std::get<Index>(key))), ...);
    return is_known ? position : capacity;
  }
  static int checked(const key_type& key) {
    const int found = position(key);
    if (found == capacity) throw ModelFault{"AOS215", "a key that its map variable does not have"};
    return found;
  }

  T values_[capacity > 0 ? capacity : 1] = {};
};

}

template <class Key, class T>
struct std::tuple_size<aos::TableEntry<Key, T>> : std::integral_constant<std::size_t, 2> {};
template <class Key, class T>
struct std::tuple_element<0, aos::TableEntry<Key, T>> {
  using type = const Key;
};
template <class Key, class T>
struct std::tuple_element<1, aos::TableEntry<Key, T>> {
  using type = T;
};
