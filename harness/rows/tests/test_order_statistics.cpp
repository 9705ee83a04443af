// Tests of intervals of order statistics against coverages that can be counted, and against many draws.
#include "rows/order_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace podm::bench {
namespace {

std::vector<double> one_to(int n) {
  std::vector<double> samples(static_cast<std::size_t>(n));
  std::iota(samples.begin(), samples.end(), 1.0);
  return samples;
}

std::vector<double> noisy(double median, int n, double deviation, std::mt19937_64& random) {
  std::lognormal_distribution<double> noise(std::log(median), deviation);
  std::vector<double> samples(static_cast<std::size_t>(n));
  for (double& sample : samples) sample = noise(random);
  return samples;
}

TEST(Median, OfKnownSamples) {
  EXPECT_EQ(median({3}), 3);
  EXPECT_EQ(median({4, 1}), 2.5);
  EXPECT_EQ(median({9, 1, 2}), 2);
  EXPECT_EQ(median({8, 1, 4, 2}), 3);
}

TEST(Median, HalfTheSamplesAreOnEitherSide) {
  std::mt19937_64 random(1);
  for (int num_samples = 1; num_samples < 40; ++num_samples) {
    const std::vector<double> samples = noisy(2, num_samples, 0.1, random);
    const double middle = median(samples);
    const auto num_at_most =
        std::count_if(samples.begin(), samples.end(), [&](double s) { return s <= middle; });
    const auto num_at_least =
        std::count_if(samples.begin(), samples.end(), [&](double s) { return s >= middle; });
    EXPECT_GE(2 * num_at_most, num_samples);
    EXPECT_GE(2 * num_at_least, num_samples);
  }
}

// Counts the 2^n ways in which n samples lie about the median. The ways that leave no sample, or too few, on
// one side are not covered.
TEST(MedianInterval, HasTheCoverageThatCountingGives) {
  const struct {
    int n;
    double low, high, coverage;
  } counted[] = {{1, 1, 1, 0},
                 {2, 1, 2, 0.5},
                 {3, 1, 3, 0.75},
                 {4, 1, 4, 0.875},
                 {5, 1, 5, 0.9375},
                 {6, 1, 6, 31.0 / 32},
                 {7, 1, 7, 63.0 / 64},
                 {8, 1, 8, 127.0 / 128},
                 {9, 2, 8, 1 - 20.0 / 512},
                 {10, 2, 9, 1 - 22.0 / 1024},
                 {12, 3, 10, 1 - 158.0 / 4096}};
  for (const auto& [n, low, high, coverage] : counted) {
    const Interval interval = median_interval(one_to(n));
    EXPECT_EQ(interval.low, low) << n;
    EXPECT_EQ(interval.high, high) << n;
    EXPECT_NEAR(interval.coverage, coverage, 1e-12) << n;
  }
}

TEST(MedianInterval, IsTheNarrowestThatHasTheConfidence) {
  for (int n = 2; n < 60; ++n)
    for (const double confidence : {0.5, 0.8, 0.95, 0.99}) {
      const Interval interval = median_interval(one_to(n), confidence);
      EXPECT_TRUE(interval.coverage >= confidence || interval.low == 1) << n << " " << confidence;
      EXPECT_EQ(interval.low + interval.high, n + 1) << "as many samples are left aside on either side";
      // One sample less on either side would fall short: the coverage then loses the next term of the
      // binomial tail on both sides.
      const double more =
          interval.coverage - 2 * std::exp(std::lgamma(n + 1) - std::lgamma(interval.low + 1) -
                                           std::lgamma(n - interval.low + 1) - n * std::log(2));
      if (interval.low < interval.high - 1) {
        EXPECT_LT(more, confidence) << n << " " << confidence;
      }
    }
}

TEST(MedianInterval, HoldsTheMedianAsOftenAsItSays) {
  std::mt19937_64 random(5);
  for (const int n : {3, 6, 9, 15}) {
    int num_held = 0;
    double coverage = 0;
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      const Interval interval = median_interval(noisy(2, n, 0.3, random));
      coverage = interval.coverage;
      num_held += interval.low <= 2 && 2 <= interval.high;
    }
    EXPECT_NEAR(num_held / double{kDraws}, coverage, 4 * std::sqrt(0.25 / kDraws)) << n;
  }
}

TEST(MedianInterval, DoesNotDependOnTheOrder) {
  const Interval interval = median_interval({3, 1, 2, 9, 4, 5});
  EXPECT_EQ(interval.low, 1);
  EXPECT_EQ(interval.high, 9);
}

TEST(FewestSamples, AreSixFor95Percent) {
  EXPECT_EQ(fewest_samples(), 6);
  EXPECT_EQ(fewest_samples(0.75), 3);
  EXPECT_EQ(fewest_samples(0.99), 8);
}

TEST(RatioInterval, OfIndependentSeriesHoldsAtLeastAsOftenAsItSays) {
  std::mt19937_64 random(7);
  for (const int n : {3, 7, 12}) {
    int num_held = 0;
    double coverage = 0;
    constexpr int kDraws = 2000;
    for (int i = 0; i < kDraws; ++i) {
      const Interval interval = ratio_interval(noisy(3, n, 0.2, random), noisy(2, n + 1, 0.2, random));
      coverage = interval.coverage;
      num_held += interval.low <= 1.5 && 1.5 <= interval.high;
    }
    EXPECT_GE(num_held / double{kDraws}, coverage - 4 * std::sqrt(0.25 / kDraws)) << n;
  }
}

TEST(RatioInterval, OverNothingIsInfinite) {
  EXPECT_EQ(ratio_of_numbers(0, 0), 1);
  EXPECT_EQ(ratio_of_numbers(1, 0), std::numeric_limits<double>::infinity());
  const Interval interval = ratio_interval({1, 2}, {0, 4});
  EXPECT_EQ(interval.low, 0.25);
  EXPECT_EQ(interval.high, std::numeric_limits<double>::infinity());
}

TEST(SamplesNeeded, GrowAsTheBoundComesNearAndTheSpreadGrows) {
  const std::vector<double> samples{0.9, 1, 1.1};
  EXPECT_EQ(samples_needed(samples, 5), fewest_samples());
  int last = 0;
  for (const double bound : {1.5, 1.2, 1.1, 1.05}) {
    const auto needed = samples_needed(samples, bound);
    ASSERT_TRUE(needed);
    EXPECT_EQ(needed, samples_needed(samples, 2 - bound)) << "as far on the other side";
    EXPECT_GE(*needed, last);
    last = *needed;
  }
  EXPECT_GT(*samples_needed({0.8, 1, 1.2}, 1.1), *samples_needed(samples, 1.1));
}

TEST(SamplesNeeded, AreNotKnownOfOneNorOnTheBound) {
  EXPECT_FALSE(samples_needed({1}, 2));
  EXPECT_FALSE(samples_needed({0.9, 1, 1.1}, 1));
  EXPECT_FALSE(samples_needed({0.9, 1, 1.1}, 1.0001)) << "more than anyone would run";
}

// An experiment of that size then lies on one side of the bound about half the time.
TEST(SamplesNeeded, ResolveTheBoundAboutHalfTheTime) {
  std::mt19937_64 random(3);
  const auto needed = samples_needed(noisy(1, 400, 0.1, random), 1.05);
  ASSERT_TRUE(needed);
  int num_resolved = 0;
  for (int i = 0; i < 1000; ++i) num_resolved += median_interval(noisy(1, *needed, 0.1, random)).high < 1.05;
  EXPECT_GT(num_resolved, 350);
  EXPECT_LT(num_resolved, 750);
}

}  // namespace
}  // namespace podm::bench
