// Where pages lie. Containers may forbid the query; it must then say so.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <thread>

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
  for (const void* address :
       {static_cast<const void*>(&memory[0]), static_cast<const void*>(&memory[kBytes - 1]),
        static_cast<const void*>(nullptr)}) {
    const PageNode home = node_of_page(address);
    EXPECT_EQ(home.os_index.has_value(), home.unavailable.empty());
  }
}

TEST(NumaMemory, IsNowhereBeforeItsFirstTouch) {
  HugeArray<char> memory(kBytes);
  EXPECT_FALSE(node_of_page(&memory[kBytes / 2]).os_index);
  EXPECT_FALSE(node_of_page(&memory[kBytes / 2]).os_index) << "the query itself does not touch";
  EXPECT_FALSE(node_of_page(nullptr).os_index);
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
    const PageNode home = node_of_page(&memory[kBytes / 2 + 1]);
    if (!home.os_index) GTEST_SKIP() << "skipped: " << home.unavailable;
    EXPECT_EQ(*home.os_index, machine.node_os_index(processor.node));
  }
  EXPECT_FALSE(nodes.empty());
}

}  // namespace
}  // namespace podm::test
