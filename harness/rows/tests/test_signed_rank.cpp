// Tests of the Hodges-Lehmann estimate and its interval by their properties and by counting all cases.
#include "rows/signed_rank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace podm::bench {
namespace {

using Samples = std::vector<double>;

Samples drawn(std::size_t num_samples, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Samples samples(num_samples);
  for (double& sample : samples) sample = normal(random);
  return samples;
}

bool holds(const CentreEstimate& estimate, double centre) {
  return estimate.low <= centre && centre <= estimate.high;
}

// The signs of the samples are drawn; all cases are equally likely.
double share_of_signs_that_hold_zero(std::size_t num_samples, double confidence) {
  const std::size_t num_cases = std::size_t{1} << num_samples;
  int num_held = 0;
  for (std::size_t signs = 0; signs < num_cases; ++signs) {
    Samples samples;
    for (std::size_t i = 0; i < num_samples; ++i)
      samples.push_back((signs >> i & 1 ? 1 : -1) * (std::sqrt(2.0) + static_cast<double>(i * i * i)));
    num_held += holds(signed_rank_estimate(samples, confidence), 0);
  }
  return num_held / static_cast<double>(num_cases);
}

TEST(SignedRank, IntervalHoldsTheCentreAsOftenAsItSaysAndHardlyMoreOften) {
  for (const double confidence : {0.8, 0.95, 0.99}) {
    const double share = share_of_signs_that_hold_zero(11, confidence);
    EXPECT_GE(share, confidence);
    EXPECT_LT(share, confidence + 0.03);
  }
}

TEST(SignedRank, TooFewSamplesHaveNoInterval) {
  EXPECT_TRUE(std::isinf(signed_rank_estimate(Samples{1, 2, 3, 4, 5}, 0.95).high));
  const CentreEstimate six =
      signed_rank_estimate(Samples{1, 2, 3, 4, 5, 6}, 0.95);  // 2 of 64 cases lie outside
  EXPECT_EQ(six.low, 1);
  EXPECT_EQ(six.high, 6);
}

TEST(SignedRank, MovesScalesAndIsMirroredWithTheSamples) {
  std::mt19937_64 random(1);
  for (std::size_t num_samples = 8; num_samples < 30; ++num_samples) {
    Samples samples = drawn(num_samples, random);
    const CentreEstimate before = signed_rank_estimate(samples, 0.9);
    EXPECT_LE(before.low, before.value);
    EXPECT_LE(before.value, before.high);
    for (double& sample : samples) sample = 5 - 2 * sample;
    const CentreEstimate after = signed_rank_estimate(samples, 0.9);
    EXPECT_NEAR(after.value, 5 - 2 * before.value, 1e-12);
    EXPECT_NEAR(after.low, 5 - 2 * before.high, 1e-12);
    EXPECT_NEAR(after.high, 5 - 2 * before.low, 1e-12);
  }
}

TEST(SignedRank, OneOutlierMovesItLittle) {
  Samples samples{0.9, 0.95, 1, 1, 1.05, 1.1, 1.02, 0.98, 1.01, 0.99, 1.03, 0.97};
  const CentreEstimate before = signed_rank_estimate(samples, 0.9);
  samples[3] = 1000;
  const CentreEstimate after = signed_rank_estimate(samples, 0.9);
  EXPECT_NEAR(after.value, before.value, 0.03);
  EXPECT_LT(after.high, 1.1);
}

}  // namespace
}  // namespace podm::bench
