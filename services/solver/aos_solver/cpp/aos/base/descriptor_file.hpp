// A file that this process was given as a descriptor. It opens none by itself: it may not.
//
// Others may have the same descriptor, so that each reads and writes at places of its own.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>

#include "aos/base/list.hpp"

namespace aos {

class DescriptorFile {
 public:
  // A negative descriptor stands for no file.
  explicit DescriptorFile(int descriptor) : descriptor_(descriptor) {}

  bool is_open() const { return descriptor_ >= 0; }
  // Whether all was read and written since the last `seek`.
  bool is_good() const { return is_good_; }
  off_t place() const { return place_ + static_cast<off_t>(unwritten_.size()); }

  // Goes on at this place, once what was to be written has been.
  void seek(off_t place) {
    flush();
    place_ = place;
    is_good_ = is_open();
  }

  void write(const void* from, std::size_t count) {
    const auto* const bytes = static_cast<const char*>(from);
    unwritten_.insert(unwritten_.end(), bytes, bytes + count);
    if (unwritten_.size() >= buffer_bytes) flush();
  }
  void write(std::string_view text) { write(text.data(), text.size()); }

  // Returns whether all was written since the last `seek`.
  bool flush() {
    std::size_t written = 0;
    while (is_good_ && written < unwritten_.size()) {
      const ssize_t count = ::pwrite(descriptor_, unwritten_.data() + written, unwritten_.size() - written, place_);
      if (count < 0 && errno == EINTR) continue;
      is_good_ = count > 0;
      if (!is_good_) break;
      written += static_cast<std::size_t>(count);
      place_ += count;
    }
    unwritten_.clear();
    return is_good_;
  }

  void read(void* to, std::size_t count) {
    auto* bytes = static_cast<char*>(to);
    while (is_good_ && count > 0) {
      const ssize_t got = ::pread(descriptor_, bytes, count, place_);
      if (got < 0 && errno == EINTR) continue;
      is_good_ = got > 0;
      if (!is_good_) break;
      bytes += got;
      count -= static_cast<std::size_t>(got);
      place_ += got;
    }
  }

 private:
  static constexpr std::size_t buffer_bytes = std::size_t{1} << 16;

  int descriptor_;
  off_t place_ = 0;
  bool is_good_ = descriptor_ >= 0;
  List<char> unwritten_;
};

}
