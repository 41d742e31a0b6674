// A list that grows up to a fixed capacity without ever moving its elements. Memory is reserved at once and, as operating
// systems do it, taken as it is used; clearing keeps it.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

namespace aos {

template <class T>
class Arena {
 public:
  explicit Arena(std::size_t capacity)
      : capacity_(capacity), elements_(static_cast<T*>(std::malloc(capacity * sizeof(T))), &std::free) {
    if (!elements_) throw std::bad_alloc{};
  }
  Arena(Arena&& other) noexcept
      : capacity_(other.capacity_), size_(std::exchange(other.size_, 0)), elements_(std::move(other.elements_)) {}
  Arena& operator=(Arena&& other) noexcept {
    std::swap(capacity_, other.capacity_);
    std::swap(size_, other.size_);
    elements_.swap(other.elements_);
    return *this;
  }
  ~Arena() { clear(); }

  // There must be room.
  T& push_back(const T& value) { return *new (&elements_.get()[size_++]) T(value); }
  bool has_room_for(std::size_t more) const { return size_ + more <= capacity_; }
  void resize_down(std::size_t size) {
    std::destroy(data() + size, data() + size_);
    size_ = size;
  }
  void clear() { resize_down(0); }

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
