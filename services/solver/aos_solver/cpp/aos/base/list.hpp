// The engine's list: what it needs of std::vector, of which it has 165 types, in a fraction of the time to compile.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace aos {

namespace detail {

// Memory for `bytes`, with the first `kept` of what was there. Throws std::bad_alloc.
[[gnu::noinline]] inline void* grown(void* before, std::size_t kept, std::size_t bytes, std::size_t alignment) {
  if (bytes > PTRDIFF_MAX) throw std::bad_alloc{};
  const bool is_usual = alignment <= alignof(std::max_align_t);
  void* const memory = is_usual ? std::realloc(before, bytes) : std::aligned_alloc(alignment, bytes);
  if (memory == nullptr) throw std::bad_alloc{};
  if (!is_usual && before != nullptr) {
    std::memcpy(memory, before, kept);
    std::free(before);
  }
  return memory;
}

}  // namespace detail

// As std::vector; iterators are pointers. Elements must not throw when they are moved.
template <class T>
class List {
  // Whether bytes may be copied; std::pair assigns by a function of its own, and copies as bytes.
  static constexpr bool is_plain = std::is_trivially_copy_constructible_v<T> && std::is_trivially_destructible_v<T>;

 public:
  using value_type = T;
  using size_type = std::size_t;  // these are for std::priority_queue
  using reference = T&;
  using const_reference = const T&;

  List() = default;
  explicit List(std::size_t size) : List() { resize(size); }
  List(std::size_t size, const T& value) : List() { resize(size, value); }
  List(std::initializer_list<T> values) : List() { append(values.begin(), values.end()); }
  template <std::input_iterator Iterator>
  List(Iterator first, Iterator last) : List() {
    append(first, last);
  }
  List(const List& other) : List() { append(other.begin(), other.end()); }
  List(List&& other) noexcept : data_(other.data_), size_(other.size_), capacity_(other.capacity_) { other.abandon(); }
  ~List() { free(); }

  List& operator=(const List& other) {
    if (this != &other) assign(other.begin(), other.end());
    return *this;
  }
  List& operator=(List&& other) noexcept {
    if (this == &other) return *this;
    free();
    data_ = other.data_, size_ = other.size_, capacity_ = other.capacity_;
    other.abandon();
    return *this;
  }

  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  auto rbegin() const { return std::reverse_iterator{end()}; }
  auto rend() const { return std::reverse_iterator{begin()}; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }

  T& operator[](std::size_t place) { return data_[checked(place)]; }
  const T& operator[](std::size_t place) const { return data_[checked(place)]; }
  T& front() { return (*this)[0]; }
  const T& front() const { return (*this)[0]; }
  T& back() { return (*this)[size_ - 1]; }
  const T& back() const { return (*this)[size_ - 1]; }

  // Whether so many more elements leave all others where they are.
  bool has_room(std::size_t more) const { return size_ + more <= capacity_; }
  void reserve(std::size_t capacity) {
    if (capacity > capacity_) grow_to(capacity);
  }
  void clear() { shrink(0); }
  void pop_back() { shrink(checked(size_ - 1)); }
  void resize(std::size_t size) {
    if (size <= size_) return shrink(size);
    make_room(size - size_);
    if constexpr (is_plain && std::is_trivially_default_constructible_v<T>) {
      std::memset(static_cast<void*>(end()), 0, (size - size_) * sizeof(T));
    } else {
      for (T* each = end(); each != data_ + size; ++each) ::new (static_cast<void*>(each)) T();
    }
    size_ = size;
  }
  void resize(std::size_t size, const T& value) {
    if (size <= size_) return shrink(size);
    const T added{value};
    make_room(size - size_);
    for (T* each = end(); each != data_ + size; ++each) ::new (static_cast<void*>(each)) T(added);
    size_ = size;
  }

  void push_back(const T& value) { emplace_back(value); }
  void push_back(T&& value) { emplace_back(std::move(value)); }
  template <class... Values>
  T& emplace_back(Values&&... values) {
    if (size_ == capacity_) return emplace_in_more(std::forward<Values>(values)...);
    T* const added = std::construct_at(end(), std::forward<Values>(values)...);
    ++size_;
    return *added;
  }

  void assign(std::size_t size, const T& value) {
    const T added{value};
    clear();
    reserve(size);
    resize(size, added);
  }
  template <std::input_iterator Iterator>
  void assign(Iterator first, Iterator last) {
    clear();
    append(first, last);
  }

  T* insert(const T* place, const T& value) {
    const std::size_t at = place - data_;
    push_back(value);
    std::rotate(data_ + at, end() - 1, end());
    return data_ + at;
  }
  template <std::input_iterator Iterator>
  T* insert(const T* place, Iterator first, Iterator last) {
    const std::size_t at = place - data_, before = size_;
    append(first, last);
    if (at < before) std::rotate(data_ + at, data_ + before, end());
    return data_ + at;
  }
  T* erase(const T* place) { return erase(place, place + 1); }
  T* erase(const T* first, const T* last) {
    T* const at = data_ + (first - data_);
    if (first != last) shrink(std::move(data_ + (last - data_), end(), at) - data_);
    return at;
  }
  void swap(List& other) noexcept { std::swap(*this, other); }

  friend bool operator==(const List& left, const List& right) {
    return left.size_ == right.size_ && std::equal(left.begin(), left.end(), right.begin());
  }
  friend auto operator<=>(const List& left, const List& right) {
    return std::lexicographical_compare_three_way(left.begin(), left.end(), right.begin(), right.end());
  }
  template <class IsErased>
  friend std::size_t erase_if(List& list, IsErased is_erased) {
    const std::size_t before = list.size_;
    list.shrink(std::remove_if(list.begin(), list.end(), is_erased) - list.data_);
    return before - list.size_;
  }

 private:
  // In a build with AOS_CHECKED, such as that of the engine's own tests, a place without an element ends the process.
  std::size_t checked(std::size_t place) const {
#ifdef AOS_CHECKED
    if (place >= size_) std::abort();
#endif
    return place;
  }

  template <class... Values>
  [[gnu::noinline]] T& emplace_in_more(Values&&... values) {
    T added(std::forward<Values>(values)...);  // of elements, perhaps
    make_room(1);
    return *::new (static_cast<void*>(data_ + size_++)) T(std::move(added));
  }

  // A range of a list that is not this one's.
  template <class Iterator>
  void append(Iterator first, Iterator last) {
    if constexpr (std::forward_iterator<Iterator>) make_room(static_cast<std::size_t>(std::distance(first, last)));
    if constexpr (is_plain && std::is_convertible_v<Iterator, const T*>) {
      const T* const from = first;
      const std::size_t added = last - first;
      if (added > 0) std::memcpy(static_cast<void*>(end()), from, added * sizeof(T));
      size_ += added;
    } else {
      for (; first != last; ++first) emplace_back(*first);
    }
  }

  // Twice the memory, or as much as is needed.
  void make_room(std::size_t more) {
    if (capacity_ - size_ < more) grow_to(size_ + std::max(size_, more));
  }
  void grow_to(std::size_t capacity) {
    if (capacity > PTRDIFF_MAX / sizeof(T)) throw std::bad_alloc{};
    if constexpr (is_plain) {
      data_ = static_cast<T*>(detail::grown(data_, size_ * sizeof(T), capacity * sizeof(T), alignof(T)));
    } else {
      T* const more = static_cast<T*>(detail::grown(nullptr, 0, capacity * sizeof(T), alignof(T)));
      for (std::size_t place = 0; place < size_; ++place) {
        ::new (static_cast<void*>(more + place)) T(std::move(data_[place]));
        data_[place].~T();
      }
      std::free(data_);
      data_ = more;
    }
    capacity_ = capacity;
  }
  void shrink(std::size_t size) {
    if constexpr (!std::is_trivially_destructible_v<T>) {
      for (T* each = data_ + size; each != end(); ++each) each->~T();
    }
    size_ = size;
  }
  void free() {
    shrink(0);
    std::free(data_);
  }
  void abandon() { data_ = nullptr, size_ = 0, capacity_ = 0; }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace aos
