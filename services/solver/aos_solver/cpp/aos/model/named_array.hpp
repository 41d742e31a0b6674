// Arrays whose elements are the values of an enum: `state.at[Soda]`.
#pragma once

#include "aos/model/containers.hpp"

namespace aos {

[[noreturn, gnu::cold]] void wrong_length(std::size_t given, std::size_t size);

// A T for each of the `Size` values of the enum E. It is indexed by a value or by its number; an index out of range is a
// ModelFault, and another enum does not compile. Lists are assigned to it as wholes: one of another length is a ModelFault.
template <class E, std::size_t Size, class T>
class Named : public Elements<Named<E, Size, T>, T> {
 public:
  using index_enum = E;

  Named() = default;
  Named(std::initializer_list<T> values) { copy(values.begin(), values.size()); }
  template <class U>
  Named(const std::vector<U>& values) { copy(values.begin(), values.size()); }
  template <class U, std::size_t Capacity>
  Named(const Vector<U, Capacity>& values) { copy(values.begin(), values.size()); }
  static Named filled(const T& value) {
    Named made;
    made.fill(value);
    return made;
  }
  static Named filled(std::initializer_list<T> values) { return Named(values); }

  static constexpr std::size_t size() { return Size; }
  static constexpr std::size_t max_size() { return Size; }
  static constexpr bool empty() { return Size == 0; }

  T& operator[](E index) { return values_[checked(static_cast<std::ptrdiff_t>(index))]; }
  const T& operator[](E index) const { return values_[checked(static_cast<std::ptrdiff_t>(index))]; }
  T& operator[](std::ptrdiff_t index) { return values_[checked(index)]; }
  const T& operator[](std::ptrdiff_t index) const { return values_[checked(index)]; }
  template <class Other>
    requires(std::is_enum_v<Other> && !std::same_as<Other, E>)
  const T& operator[](Other another_enum) const = delete;
  T* data() { return values_; }
  const T* data() const { return values_; }

  void fill(const T& value) {
    const T copy = value;  // it may be an element
    std::fill_n(values_, Size, copy);
  }
  bool operator==(const Named& other) const
    requires std::equality_comparable<T>
  {
    return std::equal(values_, values_ + Size, other.values_);
  }

 private:
  void copy(auto values, std::size_t count) {
    if (count != Size) wrong_length(count, Size);
    std::copy_n(values, Size, values_);
  }
  static std::size_t checked(std::ptrdiff_t index) {
    if (static_cast<std::size_t>(index) >= Size) out_of_range(index, Size);
    return static_cast<std::size_t>(index);
  }

  T values_[Size > 0 ? Size : 1] = {};
};

}
