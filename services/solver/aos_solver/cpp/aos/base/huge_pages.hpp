// Memory of large tables that are read at random: most of the time of such a read is spent on finding its page.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace aos {

// An allocator that asks for pages of two megabytes, where that many are needed. The system may give small ones.
template <class T>
struct HugePages {
  using value_type = T;

  HugePages() = default;
  template <class Other>
  explicit(false) HugePages(const HugePages<Other>& /*other*/) {}

  static constexpr std::size_t page = std::size_t{2} << 20;

  T* allocate(std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (bytes < page) return static_cast<T*>(::operator new(bytes));
    void* const memory = std::aligned_alloc(page, (bytes + page - 1) / page * page);
    if (memory == nullptr) throw std::bad_alloc{};
    madvise(memory, bytes, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (count * sizeof(T) < page) ::operator delete(memory);
    else std::free(memory);
  }
  bool operator==(const HugePages&) const = default;
};

}  // namespace aos
