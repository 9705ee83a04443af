// Medians of values that vary between runs, with intervals of known coverage. No distribution is assumed.
#pragma once

#include <optional>
#include <vector>

namespace podm::bench {

/// Returns the median of at least one sample; for an even number, the mean of the middle two.
double median(std::vector<double> samples);

/// The coverage that an interval needs to decide a claim.
inline constexpr double kConfidence = 0.95;

/// An interval of samples. Before the samples are measured, it holds their median with the probability
/// `coverage`.
struct Interval {
  double low = 0, high = 0;
  double coverage = 0;
};

/// Returns the interval from the k-th least to the k-th greatest of n independent samples. The interval
/// misses the median if fewer than k samples lie on one side of the median. Its coverage is therefore 1 - 2
/// P(B < k), where B is binomial with n and 1/2. The coverage is exact for a continuous distribution and a
/// lower bound for any other. The k is the largest with the given confidence, which makes the interval the
/// narrowest. It depends on n and the confidence alone, because a choice by the samples would cost coverage.
/// If there are too few samples, k is 1 and the coverage is smaller: 93.75 % of five samples, 75 % of three,
/// 0 of one. Six have 96.9 %.
Interval median_interval(std::vector<double> samples, double confidence = kConfidence);

/// Returns the smallest number of samples that has the coverage: 6 for 95 %.
int fewest_samples(double confidence = kConfidence);

/// Returns the ratio of two numbers that are both at least 0: 1 if both are 0, infinite if only `below` is 0.
double ratio_of_numbers(double above, double below);

/// Returns the interval of the ratio of the medians of two independent series. Each median has an interval
/// with the square root of the confidence. The coverage is the product of the two coverages and is a lower
/// bound.
Interval ratio_interval(const std::vector<double>& above, const std::vector<double>& below,
                        double confidence = kConfidence);

/// Estimates the number of samples whose 95 % interval lies on one side of the bound, if further samples have
/// the same spread; at least fewest_samples(). The estimate is the one for the median of normal samples.
/// Returns nothing if there is one sample, which has no spread, if the median lies on the bound, or if the
/// number is too large to be of use.
std::optional<int> samples_needed(const std::vector<double>& samples, double bound);

}  // namespace podm::bench
