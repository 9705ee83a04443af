// Tests that the pointer chase visits all lines, and that the levels found are those of a machine.
#include <gtest/gtest.h>

#include <stdexcept>

#include "machine/memory_levels.h"
#include "machine/pointer_chase.h"

namespace podm::bench {
namespace {

TEST(PointerChase, OneCycleGoesThroughAllLines) {
  for (const std::uint64_t seed : {1, 2, 3})
    for (const std::size_t num_lines : {2, 3, 17, 1000}) {
      PointerChase chase(num_lines * PointerChase::kLineBytes, seed);
      EXPECT_EQ(chase.num_lines(), num_lines);
      EXPECT_EQ(chase.cycle_length(), num_lines) << "seed " << seed;
      chase.walk(num_lines + 5);  // not a multiple of the unrolled steps
      EXPECT_EQ(chase.cycle_length(), num_lines) << "seed " << seed;
    }
  EXPECT_EQ(PointerChase(0, 1).num_lines(), 2u);
}

TEST(PointerChase, MemoryIsPlacedBeforeItIsTouchedAndARefusalReachesTheCaller) {
  std::size_t placed_bytes = 0;
  const PointerChase chase(1 << 20, 1, [&](void* memory, std::size_t bytes) {
    EXPECT_NE(memory, nullptr);
    placed_bytes = bytes;
  });
  EXPECT_GE(placed_bytes, std::size_t{1} << 20);
  EXPECT_GE(chase.huge_page_share(), 0);
  EXPECT_LE(chase.huge_page_share(), 1);
  EXPECT_THROW(PointerChase(1 << 20, 1, [](void*, std::size_t) { throw std::runtime_error("no such node"); }),
               std::runtime_error);
}

TEST(PointerChase, TimesArePositive) {
  PointerChase chase(1 << 16, 1);
  EXPECT_GT(chase.seconds_per_load(10'000), 0);
  EXPECT_GT(cycles_per_second(), 0);
}

}  // namespace
}  // namespace podm::bench
