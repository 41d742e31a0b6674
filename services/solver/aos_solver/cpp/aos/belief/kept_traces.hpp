// The traces of beliefs in a file that outlives the process: each block stands there once, however many particles come from
// it, and a change adds what is new.
//
// Blocks that no particle comes from any more stay until there are twice as many as at first. Then all that are still needed
// are written to the other one of two areas, so that those of the change before are whole until this one is.
#pragma once

#include "aos/base/descriptor_file.hpp"
#include "aos/belief/history.hpp"

namespace aos {

class KeptTraces {
 public:
  // The blocks in the file after a change. Areas are numbered from 1; at odd numbers it is the first of the two.
  struct Extent {
    std::uint64_t area = 1;
    std::uint64_t blocks = 0;
    std::uint64_t bytes = 0;
  };

  // The two areas have `area_bytes` each, from `begin` on.
  KeptTraces(DescriptorFile& file, off_t begin, off_t area_bytes) : file_(file), begin_(begin), area_bytes_(area_bytes) {}

  // Begins a change: `keep` is called once for each lineage of all beliefs then, and `end` after the last one.
  void begin() {
    if (extent_.blocks > 2 * std::max(needed_, least_blocks)) {
      extent_ = {extent_.area + 1, 0, 0};
      needed_ = 0;
    }
    is_new_ = extent_.blocks == 0;
    file_.seek(place() + static_cast<off_t>(extent_.bytes));
  }
  void keep(const TraceLink& last) {
    for (const Trace* trace = last.get(); trace != nullptr && trace->kept.area != extent_.area; trace = trace->before.get()) {
      unkept_.push_back(trace);
    }
    for (; !unkept_.empty(); unkept_.pop_back()) {
      const Trace& trace = *unkept_.back();
      put(trace);
      trace.kept = {extent_.area, extent_.blocks++};
    }
  }
  // Whether all were written. The extent goes into the file with the change.
  bool end() {
    if (is_new_) needed_ = extent_.blocks;
    const bool is_written = file_.flush() && extent_.bytes <= static_cast<std::uint64_t>(area_bytes_);
    if (!is_written) extent_ = {extent_.area + 1, 0, 0};
    return is_written;
  }
  const Extent& extent() const { return extent_; }

  // The traces that an earlier process kept, by the numbers of their last blocks, and goes on where it was. Fewer where the
  // file cannot be read.
  List<TraceLink> restore(const Extent& extent) {
    extent_ = extent;
    needed_ = extent.blocks;
    List<char> bytes(extent.bytes <= static_cast<std::uint64_t>(area_bytes_) ? extent.bytes : 0);
    file_.seek(place());
    file_.read(bytes.data(), bytes.size());
    List<TraceLink> all;
    std::size_t next = 0;
    const auto take = [&](void* to, std::size_t count) {
      if (count > bytes.size() - next) return false;
      std::memcpy(to, bytes.data() + next, count);
      next += count;
      return true;
    };
    for (std::uint64_t number = 0; file_.is_good() && number < extent.blocks; ++number) {
      Head head{};
      if (!take(&head, sizeof head) || head.before > number || head.values > (bytes.size() - next) / sizeof(double)) break;
      Block block{List<double>(head.values), head.seed, head.likelihood, head.draws};
      if (head.values > 0) take(block.values.data(), head.values * sizeof(double));
      all.push_back(head.before == 0 ? begun_trace(std::move(block)) : longer(all[head.before - 1], std::move(block)));
      all.back()->kept = {extent.area, number};
    }
    return all;
  }

 private:
  struct Head {
    std::uint64_t before;  // the number of the block before it and 1, or 0
    std::uint64_t seed;
    double likelihood;
    std::uint32_t draws;
    std::uint32_t values;
  };

  static constexpr std::uint64_t least_blocks = 20'000;

  off_t place() const { return begin_ + (extent_.area % 2 == 1 ? 0 : area_bytes_); }
  void put(const Trace& trace) {
    const Block& block = trace.block;
    const std::uint64_t before = trace.before == nullptr ? 0 : trace.before->kept.number + 1;
    const Head head{before, block.seed, block.likelihood, block.draws, static_cast<std::uint32_t>(block.values.size())};
    file_.write(&head, sizeof head);
    if (!block.values.empty()) file_.write(block.values.data(), block.values.size() * sizeof(double));
    extent_.bytes += sizeof head + block.values.size() * sizeof(double);
  }

  DescriptorFile& file_;
  off_t begin_;
  off_t area_bytes_;
  Extent extent_;
  std::uint64_t needed_ = 0;  // the blocks that were needed when the area was begun
  bool is_new_ = false;
  List<const Trace*> unkept_;
};

}
