// Counts of accesses by kind and node, and the stored sample.
#include "runtime/access_tally.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace podm::test {
namespace {

TEST(AccessTally, CountsByKindAndNodeAndSamplesSome) {
  AccessTally tally(3);
  const std::vector<char> memory(10'000);
  std::size_t added = 0;
  for (std::size_t i = 0; i < memory.size(); ++i)
    for (std::size_t kind = 0; kind < kNumAccessKinds; ++kind, ++added)
      tally.add(static_cast<AccessKind>(kind), static_cast<NodeIndex>(i % 3), &memory[i]);
  std::uint64_t counted = 0;
  for (std::size_t kind = 0; kind < kNumAccessKinds; ++kind) {
    const auto& by_node = tally.by_node(static_cast<AccessKind>(kind));
    EXPECT_EQ(by_node, (std::vector<std::uint64_t>{3334, 3333, 3333}));
    counted += std::accumulate(by_node.begin(), by_node.end(), std::uint64_t{0});
  }
  EXPECT_EQ(counted, added);
  EXPECT_GT(tally.samples().size(), added / 2000);
  EXPECT_LT(tally.samples().size(), added / 500);
  for (const void* address : tally.samples()) {
    EXPECT_GE(address, memory.data());
    EXPECT_LT(address, memory.data() + memory.size());
  }
}

TEST(AccessTally, KeepsTheLastSamples) {
  AccessTally tally(1);
  const char early = 0, late = 0;
  for (int i = 0; i < 1'000'000; ++i) tally.add(AccessKind::kMeshRead, 0, &early);
  const std::size_t most = tally.samples().size();
  for (int i = 0; i < 1'000'000; ++i) tally.add(AccessKind::kMeshRead, 0, &late);
  EXPECT_EQ(tally.samples(), std::vector<const void*>(most, &late));
}

}  // namespace
}  // namespace podm::test
