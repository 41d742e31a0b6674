// Beliefs that outlive a process, in a file that its parent holds open. Each change of the belief has a number, and the
// parent counts those that it was told of. The file has room for two beliefs: when a process ends amid a change, the one
// before it is whole.
#pragma once

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "aos/belief/belief.hpp"
#include "aos/belief/saved_history.hpp"

namespace aos {

template <class Model>
class KeptBeliefs {
 public:
  // An empty path keeps nothing.
  explicit KeptBeliefs(const char* path) : file_(*path == '\0' ? -1 : ::open(path, O_RDWR | O_CLOEXEC)) {}
  KeptBeliefs(const KeptBeliefs&) = delete;
  KeptBeliefs& operator=(const KeptBeliefs&) = delete;
  ~KeptBeliefs() {
    if (file_ >= 0) ::close(file_);
  }

  // The belief after one more change. A file without room for it keeps none.
  void keep(const Belief<Model>& belief) {
    ++changes_;
    if (file_ < 0) return;
    const auto& particles = belief.particles();
    const Words history = saved_history(belief);
    const Head none{};
    const Head head{changes_, particles.size(), history.size(), belief.error_bound(), belief.is_drawn()};
    packed_.clear();
    for (const Particle& particle : particles) {
      pack(&particle.weight, sizeof particle.weight);
      pack(Model::bytes_of(particle.state), Model::state_bytes());
    }
    pack(history.data(), history.size() * sizeof(Words::value_type));
    if (!write(&none, sizeof none, 0) || !write(packed_.data(), packed_.size(), sizeof head)) return;
    write(&head, sizeof head, 0);
  }

  // The belief after the change of this number, from which counting goes on; nothing where it was not kept.
  std::optional<Belief<Model>> restore(std::uint64_t change) {
    changes_ = change;
    Head head;
    if (file_ < 0 || !read(&head, sizeof head, 0) || head.change != change || head.particles == 0) return std::nullopt;
    std::vector<Particle> particles(head.particles);
    Words history(head.history_words);
    packed_.resize(head.particles * (sizeof(double) + Model::state_bytes()) + history.size() * sizeof(Words::value_type));
    if (!read(packed_.data(), packed_.size(), sizeof head)) return std::nullopt;
    const std::byte* next = packed_.data();
    for (Particle& particle : particles) {
      next = unpack(next, &particle.weight, sizeof particle.weight);
      next = unpack(next, Model::bytes_of(particle.state), Model::state_bytes());
    }
    unpack(next, history.data(), history.size() * sizeof(Words::value_type));
    return Belief<Model>::of(with_history<Model>(std::move(particles), history), head.error_bound, head.is_drawn);
  }

 private:
  using Particle = aos::Particle<Model>;

  struct Head {
    std::uint64_t change;
    std::uint64_t particles;
    std::uint64_t history_words;
    double error_bound;
    bool is_drawn;
  };

  // Far apart, in a file that takes memory only for what is written.
  off_t begin() const { return static_cast<off_t>(changes_ % 2) << 36; }

  void pack(const void* from, std::size_t count) {
    const auto* const bytes = static_cast<const std::byte*>(from);
    packed_.insert(packed_.end(), bytes, bytes + count);
  }
  static const std::byte* unpack(const std::byte* from, void* to, std::size_t count) {
    std::memcpy(to, from, count);
    return from + count;
  }

  // `move(done)` moves some of the bytes after those that are done, and returns how many.
  template <class Move>
  static bool move_all(std::size_t count, Move&& move) {
    for (std::size_t done = 0; done < count;) {
      const ssize_t moved = move(done);
      if (moved < 0 && errno == EINTR) continue;
      if (moved <= 0) return false;
      done += static_cast<std::size_t>(moved);
    }
    return true;
  }
  bool write(const void* bytes, std::size_t count, std::size_t offset) const {
    const auto* const from = static_cast<const char*>(bytes);
    const off_t place = begin() + static_cast<off_t>(offset);
    return move_all(count, [&](std::size_t done) {
      return ::pwrite(file_, from + done, count - done, place + static_cast<off_t>(done));
    });
  }
  bool read(void* bytes, std::size_t count, std::size_t offset) const {
    auto* const to = static_cast<char*>(bytes);
    const off_t place = begin() + static_cast<off_t>(offset);
    return move_all(count, [&](std::size_t done) {
      return ::pread(file_, to + done, count - done, place + static_cast<off_t>(done));
    });
  }

  int file_;
  std::uint64_t changes_ = 0;
  std::vector<std::byte> packed_;  // a belief in the order of the file; its memory serves the next one
};

}  // namespace aos
