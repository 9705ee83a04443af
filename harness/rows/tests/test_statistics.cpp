// Tests of medians and bootstrap intervals by their properties, and against values found by counting.
#include "rows/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace podm::bench {
namespace {

using Samples = std::vector<double>;

Samples noisy(double level, std::size_t num_samples, std::mt19937_64& random) {
  std::lognormal_distribution<double> noise(std::log(level), 0.1);  // its median is `level`
  Samples samples(num_samples);
  for (double& sample : samples) sample = noise(random);
  return samples;
}

Samples scaled(Samples samples, double factor) {
  for (double& sample : samples) sample *= factor;
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
  for (std::size_t num_samples = 1; num_samples < 40; ++num_samples) {
    const Samples samples = noisy(2, num_samples, random);
    const double middle = median(samples);
    const auto num_at_most =
        std::count_if(samples.begin(), samples.end(), [&](double s) { return s <= middle; });
    const auto num_at_least =
        std::count_if(samples.begin(), samples.end(), [&](double s) { return s >= middle; });
    EXPECT_GE(2 * num_at_most, static_cast<std::ptrdiff_t>(num_samples));
    EXPECT_GE(2 * num_at_least, static_cast<std::ptrdiff_t>(num_samples));
  }
}

// Seven of the 27 resamples of three have the least as their median and 7 the greatest: 26 % each.
TEST(RatioOfMedians, IntervalsThatCanBeCounted) {
  const Samples ones{1, 1, 1};
  const Ratio all = ratio_of_medians(Samples{1, 2, 4}, ones, Sampling::kPaired, {.confidence = 0.95});
  EXPECT_EQ(all.value, 2);
  EXPECT_EQ(all.low, 1);
  EXPECT_EQ(all.high, 4);
  const Ratio middle = ratio_of_medians(Samples{1, 2, 4}, ones, Sampling::kPaired, {.confidence = 0.4});
  EXPECT_EQ(middle.low, 2);
  EXPECT_EQ(middle.high, 2);
}

TEST(RatioOfMedians, OneOrEqualSamplesHaveNoSpread) {
  for (const Samples& samples : {Samples{3}, Samples{3, 3, 3, 3}})
    for (const Sampling sampling : {Sampling::kPaired, Sampling::kIndependent}) {
      const Ratio ratio = ratio_of_medians(samples, scaled(samples, 2), sampling);
      EXPECT_EQ(ratio.value, 0.5);
      EXPECT_EQ(ratio.low, 0.5);
      EXPECT_EQ(ratio.high, 0.5);
    }
}

TEST(RatioOfMedians, HoldsItsValueScalesInvertsAndRepeats) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 50; ++i) {
    const Samples a = noisy(3, 9, random), b = noisy(2, 9, random);
    const Ratio ratio = ratio_of_medians(a, b, Sampling::kPaired);
    EXPECT_LE(ratio.low, ratio.value);
    EXPECT_GE(ratio.high, ratio.value);
    const Ratio twice = ratio_of_medians(scaled(a, 2), b, Sampling::kPaired);
    EXPECT_EQ(twice.low, 2 * ratio.low);
    EXPECT_EQ(twice.high, 2 * ratio.high);
    const Ratio swapped = ratio_of_medians(b, a, Sampling::kPaired);
    EXPECT_NEAR(swapped.low, 1 / ratio.high, 1e-12);
    EXPECT_NEAR(swapped.high, 1 / ratio.low, 1e-12);
    EXPECT_EQ(ratio_of_medians(a, b, Sampling::kPaired).low, ratio.low) << "the seed decides";
  }
}

TEST(RatioOfMedians, IntervalIsWiderForMoreConfidence) {
  std::mt19937_64 random(3);
  const Samples a = noisy(3, 12, random), b = noisy(2, 15, random);
  Ratio narrower = ratio_of_medians(a, b, Sampling::kIndependent, {.confidence = 0.5});
  for (const double confidence : {0.8, 0.95, 0.99}) {
    const Ratio wider = ratio_of_medians(a, b, Sampling::kIndependent, {.confidence = confidence});
    EXPECT_LE(wider.low, narrower.low);
    EXPECT_GE(wider.high, narrower.high);
    narrower = wider;
  }
}

TEST(RatioOfMedians, PairsCancelWhatTheyShare) {
  std::mt19937_64 random(4);
  const Samples drift = noisy(1, 15, random);
  const Ratio paired = ratio_of_medians(scaled(drift, 1.1), drift, Sampling::kPaired);
  EXPECT_NEAR(paired.low, 1.1, 1e-12);
  EXPECT_NEAR(paired.high, 1.1, 1e-12);
  const Ratio apart = ratio_of_medians(scaled(drift, 1.1), drift, Sampling::kIndependent);
  EXPECT_GT(apart.high - apart.low, 0.01);
}

// The bootstrap is approximate for few samples: at a confidence of 95 %, at least 90 % must hold.
TEST(RatioOfMedians, IntervalsHoldTheTruthAboutAsOftenAsAskedFor) {
  for (const Sampling sampling : {Sampling::kPaired, Sampling::kIndependent}) {
    std::mt19937_64 random(5);
    int num_held = 0;
    constexpr int kSamples = 400;
    for (int i = 0; i < kSamples; ++i) {
      const Samples a = noisy(1.5, 15, random), b = noisy(1, 15, random);
      const Ratio ratio = ratio_of_medians(a, b, sampling, {.num_resamples = 500, .seed = random()});
      num_held += ratio.low <= 1.5 && ratio.high >= 1.5;
    }
    EXPECT_GT(num_held, 0.9 * kSamples);
    EXPECT_LT(num_held, kSamples) << "an interval that never misses is too wide to be of use";
  }
}

}  // namespace
}  // namespace podm::bench
