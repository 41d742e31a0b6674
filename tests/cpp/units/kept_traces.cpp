// Traces in a file that outlives the process: kept_traces.hpp.
#include "aos/belief/kept_traces.hpp"

#include "aos/base/descriptor_file.hpp"
#include "aos/belief/history.hpp"
#include "check.hpp"

namespace units::kept_traces_tests {

using namespace aos;

constexpr off_t area_bytes = off_t{1} << 24;

bool are_equal(const TraceLink& one, const TraceLink& other) {
  const auto blocks = blocks_of(one);
  const auto others = blocks_of(other);
  bool are_equal = blocks.size() == others.size();
  for (std::size_t i = 0; are_equal && i < blocks.size(); ++i) {
    are_equal = blocks[i]->seed == others[i]->seed && blocks[i]->values == others[i]->values &&
                blocks[i]->likelihood == others[i]->likelihood && blocks[i]->draws == others[i]->draws;
  }
  return are_equal;
}

// Half of the particles vanish at each step, and two come from each of the others: most blocks are needed no more soon.
aos::List<TraceLink> grown(const aos::List<TraceLink>& before, std::uint64_t step) {
  aos::List<TraceLink> after;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::uint64_t seed = step * before.size() + i;
    aos::List<double> values(i % 3, static_cast<double>(seed));
    after.push_back(longer(before[i - i % 2], Block{std::move(values), seed, 0.5, 7}));
  }
  return after;
}

TEST("Traces come back as they were, with what they share, however often the file was cleared up") {
  const int descriptor = memfd_create("traces", 0);
  DescriptorFile file{descriptor};
  KeptTraces kept{file, 0, area_bytes};
  aos::List<TraceLink> traces;
  for (std::uint64_t i = 0; i < 1000; ++i) traces.push_back(begun_trace(Block{{}, i, 1, 0}));
  for (std::uint64_t step = 1; step <= 200; ++step) {
    kept.begin();
    for (const TraceLink& trace : traces) kept.keep(trace);
    EXPECT(kept.end());
    traces = grown(traces, step);
  }
  kept.begin();
  for (const TraceLink& trace : traces) kept.keep(trace);
  EXPECT(kept.end());
  EXPECT(kept.extent().area > 2);

  DescriptorFile again{descriptor};
  KeptTraces later{again, 0, area_bytes};
  const auto restored = later.restore(kept.extent());
  EXPECT_EQUAL(restored.size(), kept.extent().blocks);
  for (std::size_t i = 0; i < traces.size(); ++i) {
    const auto& trace = restored[traces[i]->kept.number];
    EXPECT(are_equal(trace, traces[i]));
    EXPECT_EQUAL(trace->origin == restored[traces[0]->kept.number]->origin, traces[i]->origin == traces[0]->origin);
  }
  ::close(descriptor);
}

TEST("Traces for which the file has no room are not kept, and are once there is room") {
  const int descriptor = memfd_create("traces", 0);
  DescriptorFile file{descriptor};
  KeptTraces kept{file, 0, 1000};
  kept.begin();
  kept.keep(begun_trace(Block{aos::List<double>(1000), 1, 1, 1}));
  EXPECT(!kept.end());
  kept.begin();
  kept.keep(begun_trace(Block{{}, 1, 1, 1}));
  EXPECT(kept.end());
  ::close(descriptor);
}

}
