// Tests of sums over the ranges of several threads.
#include "claims/tally.h"

#include <gtest/gtest.h>

#include "claim.h"

namespace podm::verify {
namespace {

// The indices that a thread visited. Adding keeps their order.
struct Visited {
  std::vector<std::size_t> indices;
  void add(const Visited& other) {
    indices.insert(indices.end(), other.indices.begin(), other.indices.end());
  }
};

TEST(SumOverRanges, IsTheSerialSumForAnyNumberOfThreads) {
  for (const std::size_t count : {0, 1, 5, 64})
    for (const int threads : {0, 1, 2, 3, 7, 100}) {
      const Visited sum =
          sum_over_ranges(count, threads, Visited{}, [](std::size_t begin, std::size_t end, Visited& part) {
            for (std::size_t i = begin; i < end; ++i) part.indices.push_back(i);
          });
      ASSERT_EQ(sum.indices.size(), count) << threads;
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(sum.indices[i], i) << threads;
    }
}

TEST(TallyOver, AddsUpCountsWitnessesAndBins) {
  for (const int threads : {1, 3}) {
    Tally empty;
    empty.bins.push_back(bins_of_degrees("angle"));
    const Tally tally = tally_over({0, 90}, threads, empty, [](std::size_t i, Tally& part) {
      ++part.num_checked;
      part.bins[0].add(static_cast<double>(i));
      if (i % 30 == 0) part.violation({.statement = "s", .cells = {i}, .severity = static_cast<double>(i)});
    });
    const ClaimResult result = result_of("claim", tally);
    EXPECT_EQ(result.verdict, Verdict::kFail);
    EXPECT_EQ(result.num_checked, 90u);
    EXPECT_EQ(result.num_violations, 3u);
    EXPECT_EQ(result.bad_cells, (std::vector<GlobalId>{0, 30, 60}));
    EXPECT_EQ(result.worst.at(0).severity, 60) << "the worst first";
    const Histogram& angles = result.histograms.at(0);
    EXPECT_EQ(angles.minimum, 0);
    EXPECT_EQ(angles.maximum, 89);
    EXPECT_EQ(angles.counts.at(30), 1u);
  }
}

}  // namespace
}  // namespace podm::verify
