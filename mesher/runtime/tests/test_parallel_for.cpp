#include "runtime/parallel_for.h"

#include <gtest/gtest.h>

#include <numeric>

namespace podm::test {
namespace {

TEST(ParallelFor, RunsEveryRoundOnceOnItsThreads) {
  for (const std::size_t count : {0u, 1u, 3u, 1000u}) {
    for (const std::size_t threads : {1u, 2u, 5u}) {
      std::vector<int> rounds(count);
      std::vector<std::size_t> rounds_of(threads);
      parallel_for(count, threads, [&](std::size_t i, std::size_t thread) {
        ++rounds[i];
        ++rounds_of.at(thread);
      });
      EXPECT_EQ(rounds, std::vector<int>(count, 1));
      EXPECT_EQ(std::accumulate(rounds_of.begin(), rounds_of.end(), std::size_t{0}), count);
    }
  }
}

TEST(ParallelFor, NoNumberMeansAllCores) {
  EXPECT_EQ(num_threads(3), 3u);
  EXPECT_GE(num_threads(0), 1u);
}

}  // namespace
}  // namespace podm::test
