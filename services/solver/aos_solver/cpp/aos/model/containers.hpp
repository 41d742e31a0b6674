// Vectors of fixed storage, with the part of std::vector's interface that documents use.
#pragma once

#include <algorithm>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

namespace aos {

// These throw a ModelFault. They are kept out of the code that runs in every step.
[[noreturn, gnu::cold]] void out_of_range(std::ptrdiff_t index, std::size_t size);
[[noreturn, gnu::cold]] void no_such_key(std::size_t size);
[[noreturn, gnu::cold]] void over_capacity(std::size_t size, std::size_t max);

// What vectors and arrays of fixed storage have in common. `Self` has `data`, `size` and a checked `operator[]`.
template <class Self, class T>
class Elements {
 public:
  using value_type = T;
  using size_type = std::size_t;
  using reference = T&;
  using const_reference = const T&;
  using iterator = T*;
  using const_iterator = const T*;

  template <class U>
    requires std::is_constructible_v<U, const T&>
  operator std::vector<U>() const { return std::vector<U>(begin(), end()); }

  T& at(auto index) { return self()[index]; }
  const T& at(auto index) const { return self()[index]; }
  T& front() { return self()[std::ptrdiff_t{0}]; }
  const T& front() const { return self()[std::ptrdiff_t{0}]; }
  T& back() { return self()[static_cast<std::ptrdiff_t>(self().size()) - 1]; }
  const T& back() const { return self()[static_cast<std::ptrdiff_t>(self().size()) - 1]; }

  T* begin() { return self().data(); }
  T* end() { return self().data() + self().size(); }
  const T* begin() const { return self().data(); }
  const T* end() const { return self().data() + self().size(); }
  const T* cbegin() const { return begin(); }
  const T* cend() const { return end(); }
  auto rbegin() { return std::reverse_iterator<T*>(end()); }
  auto rend() { return std::reverse_iterator<T*>(begin()); }
  auto rbegin() const { return std::reverse_iterator<const T*>(end()); }
  auto rend() const { return std::reverse_iterator<const T*>(begin()); }

 private:
  Self& self() { return static_cast<Self&>(*this); }
  const Self& self() const { return static_cast<const Self&>(*this); }
};

// A vector of up to `Capacity` elements in place, so that a state stays trivially copyable. It converts from
// and to std::vector. An index out of range and a push beyond `Capacity` are ModelFaults.
template <class T, std::size_t Capacity>
class Vector : public Elements<Vector<T, Capacity>, T> {
 public:
  using Elements<Vector, T>::begin, Elements<Vector, T>::end, Elements<Vector, T>::back;

  Vector() = default;
  Vector(std::initializer_list<T> values) { assign(values.begin(), values.end()); }
  explicit Vector(std::size_t size, const T& value = T{}) { assign(size, value); }
  template <class U>
  Vector(const std::vector<U>& values) { assign(values.begin(), values.end()); }
  template <class U, std::size_t OtherCapacity>
  Vector(const Vector<U, OtherCapacity>& values) { assign(values.begin(), values.end()); }
  template <class Iterator>
    requires(!std::is_integral_v<Iterator>)
  Vector(Iterator first, Iterator last) { assign(first, last); }
  Vector& operator=(std::initializer_list<T> values) {
    assign(values.begin(), values.end());
    return *this;
  }

  std::size_t size() const { return size_; }
  static constexpr std::size_t max_size() { return Capacity; }
  static constexpr std::size_t capacity() { return Capacity; }
  bool empty() const { return size_ == 0; }

  T& operator[](std::ptrdiff_t index) { return values_[checked(index)]; }
  const T& operator[](std::ptrdiff_t index) const { return values_[checked(index)]; }
  T* data() { return values_; }
  const T* data() const { return values_; }

  void push_back(const T& value) {
    const T copy = value;
    values_[grown(1)] = copy;
  }
  T& emplace_back(const auto&... parts) {
    push_back(made(parts...));
    return back();
  }
  void pop_back() {
    checked(last());
    --size_;
  }
  void clear() { size_ = 0; }
  void reserve(std::size_t) {}
  void shrink_to_fit() {}
  void resize(std::size_t size, const T& value = T{}) {
    while (size_ < size) push_back(value);
    size_ = static_cast<std::uint32_t>(size);
  }
  void assign(std::size_t size, const T& value) {
    const T copy = value;
    clear();
    resize(size, copy);
  }
  void assign(std::initializer_list<T> values) { assign(values.begin(), values.end()); }
  template <class Iterator>
    requires(!std::is_integral_v<Iterator>)
  void assign(Iterator first, Iterator last) {
    clear();
    for (; first != last; ++first) values_[grown(1)] = *first;
  }
  T* insert(const T* before, const T& value) {
    const T copy = value;
    const std::ptrdiff_t position = before - values_;
    for (std::size_t index = grown(1); index > static_cast<std::size_t>(position); --index) {
      values_[index] = values_[index - 1];
    }
    values_[position] = copy;
    return values_ + position;
  }
  template <class Iterator>
    requires(!std::is_integral_v<Iterator>)
  T* insert(const T* before, Iterator first, Iterator last) {
    const std::vector<T> added(first, last);  // the elements may be this vector's own
    const std::ptrdiff_t position = before - values_;
    grown(added.size());
    for (T *from = end() - added.size(), *to = end(); from != values_ + position;) *--to = *--from;
    T* to = values_ + position;
    for (const auto& value : added) *to++ = value;
    return values_ + position;
  }
  T* insert(const T* before, std::initializer_list<T> values) { return insert(before, values.begin(), values.end()); }
  T* insert(const T* before, std::size_t count, const T& value) {
    const std::vector<T> added(count, value);
    return insert(before, added.begin(), added.end());
  }
  T* erase(const T* position) { return erase(position, position + 1); }
  T* erase(const T* first, const T* last) {
    T* to = values_ + (first - values_);
    for (const T* from = last; from != end(); ++from) *to++ = *from;
    size_ = static_cast<std::uint32_t>(to - values_);
    return values_ + (first - values_);
  }
  T* emplace(const T* before, const auto&... parts) { return insert(before, made(parts...)); }
  void flip()
    requires std::same_as<T, bool>
  {
    for (bool& value : *this) value = !value;
  }
  void fill(const T& value) { assign(size_, value); }
  template <class Other>
  void swap(Other& other) {
    const Other mine(*this);
    *this = Vector(other);
    other = mine;
  }

  template <std::size_t OtherCapacity>
  friend bool operator==(const Vector& left, const Vector<T, OtherCapacity>& right) {
    if (left.size() != right.size()) return false;
    for (std::size_t index = 0; index < left.size(); ++index) {
      if (!(left.begin()[index] == right.begin()[index])) return false;
    }
    return true;
  }
  template <class Other>
    requires std::three_way_comparable<T> && std::same_as<typename Other::value_type, T>
  friend auto operator<=>(const Vector& left, const Other& right) {
    return std::lexicographical_compare_three_way(left.begin(), left.end(), right.begin(), right.end());
  }
  friend bool operator==(const Vector& left, const std::vector<T>& right) { return std::vector<T>(left) == right; }

 private:
  static T made(const auto&... parts) {
    if constexpr (std::is_constructible_v<T, decltype(parts)...>) {
      return T(parts...);
    } else {
      return T{parts...};
    }
  }
  std::size_t checked(std::ptrdiff_t index) const {
    if (static_cast<std::size_t>(index) >= size_) out_of_range(index, size_);
    return static_cast<std::size_t>(index);
  }
  std::ptrdiff_t last() const { return static_cast<std::ptrdiff_t>(size_) - 1; }
  // Adds `more` elements and returns the index of the first.
  std::size_t grown(std::size_t more) {
    const std::size_t before = size_;
    if (before + more > Capacity) over_capacity(before + more, Capacity);
    size_ = static_cast<std::uint32_t>(before + more);
    return before;
  }

  T values_[Capacity] = {};
  std::uint32_t size_ = 0;
};

template <class T, std::size_t Capacity, class Predicate>
std::size_t erase_if(Vector<T, Capacity>& values, Predicate is_erased) {
  const std::size_t before = values.size();
  values.erase(std::remove_if(values.begin(), values.end(), is_erased), values.end());
  return before - values.size();
}
template <class T, std::size_t Capacity, class Value>
std::size_t erase(Vector<T, Capacity>& values, const Value& value) {
  const std::decay_t<const Value&> erased(value);  // it may be an element
  return erase_if(values, [&](const T& other) { return other == erased; });
}
// A part of the state with what code holds in a standard type.
template <class Left, class Right>
  requires(std::convertible_to<Left, Right> && std::convertible_to<Right, Left> && !std::same_as<Left, Right>)
void swap(Left& left, Right& right) {
  const Right mine = left;
  left = Left(right);
  right = mine;
}

// The type that a pointer of document code to `Standard` has: that of the first part of the state that stands
// for it, else `Standard`.
template <class Standard, class... Parts>
struct HeldType { using type = Standard; };
template <class Standard, class Part, class... Parts>
struct HeldType<Standard, Part, Parts...> : HeldType<Standard, Parts...> {};
template <class Standard, class Part, class... Parts>
  requires(std::convertible_to<Part, Standard> &&
           std::same_as<typename Standard::value_type, typename std::remove_reference_t<Part>::value_type>)
struct HeldType<Standard, Part, Parts...> { using type = std::remove_reference_t<Part>; };
template <class Standard, class... Parts>
using Held = typename HeldType<Standard, Parts...>::type;

inline void flip(bool& element) { element = !element; }
void flip(auto&& element) { element.flip(); }

// `values[index]` of document code: a ModelFault where a vector, an array or a string has no such element.
template <class Values, class Index>
constexpr decltype(auto) at(Values&& values, const Index& index) {
  if constexpr (std::is_convertible_v<Index, std::ptrdiff_t> && !requires { typename std::remove_cvref_t<Values>::key_type; }) {
    if constexpr (requires { std::size(values); }) {
      const auto number = static_cast<std::ptrdiff_t>(index);
      if (static_cast<std::size_t>(number) >= std::size(values)) out_of_range(number, std::size(values));
    }
  }
  return values[index];
}

// What `values.back()` and its like of document code are asked of: a ModelFault where it has no element.
template <class Values>
constexpr Values&& filled(Values&& values) {
  if constexpr (requires { values.empty(); }) {
    if (values.empty()) out_of_range(0, 0);
  }
  return std::forward<Values>(values);
}

}
