// A list that grows up to a fixed capacity without ever moving its elements. Memory is reserved at once and, as operating
// systems do it, taken as it is used; clearing keeps it.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace aos {

template <class T>
class Arena {
 public:
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  explicit Arena(std::size_t capacity)
      : capacity_(capacity), elements_(static_cast<T*>(std::malloc(capacity * sizeof(T))), &std::free) {
    if (!elements_) throw std::bad_alloc{};
  }

  // There must be room.
  T& push_back(const T& value) { return *new (&elements_.get()[size_++]) T(value); }
  bool has_room_for(std::size_t more) const { return size_ + more <= capacity_; }
  void resize_down(std::size_t size) { size_ = size; }
  void clear() { size_ = 0; }

  std::size_t size() const { return size_; }
  T* data() { return elements_.get(); }
  T& operator[](std::size_t index) { return elements_.get()[index]; }
  const T& operator[](std::size_t index) const { return elements_.get()[index]; }

 private:
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::unique_ptr<T[], void (*)(void*)> elements_;
};

}  // namespace aos
