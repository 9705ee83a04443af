#include "runtime/parallel_sort.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace podm::test {
namespace {

// Lengths around those at which the number of sorted runs changes, and threads that are no power of two.
TEST(ParallelSort, EqualsSortingOnOneThread) {
  std::mt19937_64 random(3);
  for (const std::size_t size : {0u, 1u, 2047u, 2048u, 4095u, 4096u, 4097u, 10'007u, 70'000u})
    for (const std::uint64_t num_values : {2ull, 1000ull, 1ull << 60}) {
      std::vector<std::uint64_t> values(size);
      for (std::uint64_t& value : values) value = random() % num_values;
      std::vector<std::uint64_t> expected = values;
      std::sort(expected.begin(), expected.end(), std::greater<>());
      for (const std::size_t threads : {1u, 2u, 3u, 8u, 13u}) {
        std::vector<std::uint64_t> sorted = values;
        parallel_sort(sorted.begin(), sorted.end(), threads, std::greater<>());
        EXPECT_EQ(sorted, expected) << size << " values on " << threads << " threads";
      }
    }
}

TEST(ParallelSort, MovesItemsThatCannotBeCopiedByBits) {
  std::mt19937_64 random(4);
  std::vector<std::string> names(9000);
  for (std::string& name : names)
    name = "a name that is too long to be kept in place " + std::to_string(random());
  std::vector<std::string> expected = names;
  std::sort(expected.begin(), expected.end());
  parallel_sort(names.begin(), names.end(), 4);
  EXPECT_EQ(names, expected);
}

}  // namespace
}  // namespace podm::test
