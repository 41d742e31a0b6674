// States as the engine holds them: blocks of bytes that only the compiled model can read.
#pragma once

#include "aos/model/model_table.hpp"

namespace aos {

// A state of up to `Size` bytes, in place.
template <std::size_t Size>
struct InPlaceState {
  alignas(std::uint64_t) std::byte bytes[Size]{};

  friend bool operator==(const InPlaceState& left, const InPlaceState& right) {
    return compiled_model.equal(left.bytes, right.bytes);
  }
};

// A state of any size, in memory of its own. An object that was moved from may only be assigned to.
class OwnedState {
 public:
  std::byte* bytes;

  OwnedState() : bytes(taken()) { std::memset(bytes, 0, size()); }
  OwnedState(const OwnedState& other) : bytes(taken()) { std::memcpy(bytes, other.bytes, size()); }
  OwnedState(OwnedState&& other) noexcept : bytes(std::exchange(other.bytes, nullptr)) {}
  OwnedState& operator=(const OwnedState& other) {
    if (bytes == nullptr) bytes = taken();
    if (bytes != other.bytes) std::memcpy(bytes, other.bytes, size());
    return *this;
  }
  OwnedState& operator=(OwnedState&& other) noexcept {
    std::swap(bytes, other.bytes);
    return *this;
  }
  ~OwnedState() { std::free(bytes); }

  friend bool operator==(const OwnedState& left, const OwnedState& right) {
    return compiled_model.equal(left.bytes, right.bytes);
  }

 private:
  static std::size_t size() { return compiled_model.state_bytes; }
  static std::byte* taken() {
    auto* const block = static_cast<std::byte*>(std::malloc(size()));
    if (block == nullptr) throw std::bad_alloc{};
    return block;
  }
};

// A `Size` of 0 stands for any size.
template <std::size_t Size>
using ErasedState = std::conditional_t<Size == 0, OwnedState, InPlaceState<Size == 0 ? 1 : Size>>;

}
