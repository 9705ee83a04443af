// Queries of the node of pages. Containers may forbid the query; it must then return the reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <thread>
#include <vector>

#include "runtime/huge_array.h"
#include "runtime/numa_memory.h"
#include "runtime/placement.h"
#include "runtime/topology.h"

namespace podm::test {
namespace {

constexpr std::size_t kBytes = std::size_t{1} << 24;

TEST(NumaMemory, IsKnownOrSaysWhyNot) {
  HugeArray<char> memory(kBytes);
  memory[0] = 1;
  const PageNodes homes = nodes_of_pages(std::vector<const void*>{&memory[0], &memory[kBytes - 1], nullptr});
  EXPECT_EQ(homes.os_indices.size(), homes.unavailable.empty() ? 3u : 0u);
  EXPECT_TRUE(nodes_of_pages({}).os_indices.empty());
}

TEST(NumaMemory, IsNowhereBeforeItsFirstTouch) {
  HugeArray<char> memory(kBytes);
  const std::vector<const void*> addresses{&memory[kBytes / 2], &memory[0], nullptr};
  for (int n = 0; n < 2; ++n) {  // the query itself does not touch
    const PageNodes homes = nodes_of_pages(addresses);
    if (!homes.unavailable.empty()) GTEST_SKIP() << "skipped: " << homes.unavailable;
    EXPECT_EQ(homes.os_indices, std::vector<int>(3, PageNodes::kNowhere));
  }
  memory[0] = 1;
  const PageNodes homes = nodes_of_pages(addresses);
  EXPECT_EQ(homes.os_indices[0], PageNodes::kNowhere);
  EXPECT_GE(homes.os_indices[1], 0);
}

TEST(NumaMemory, ComesToTheNodeOfTheThreadThatTouchesItFirst) {
  const Topology machine = Topology::of_this_machine();
  std::set<int> nodes;
  for (const Processor& processor : machine.processors()) {
    if (!nodes.insert(processor.node).second) continue;
    HugeArray<char> memory(kBytes);
    std::jthread([&] {
      pin_this_thread(processor.os_index);
      std::fill_n(&memory[0], kBytes, 'x');
    }).join();
    const PageNodes home = nodes_of_pages(std::vector<const void*>{&memory[kBytes / 2 + 1]});
    if (!home.unavailable.empty()) GTEST_SKIP() << "skipped: " << home.unavailable;
    EXPECT_EQ(home.os_indices.front(), machine.node_os_index(processor.node));
  }
  EXPECT_FALSE(nodes.empty());
}

}  // namespace
}  // namespace podm::test
