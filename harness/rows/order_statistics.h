// Medians of what varies from run to run, with intervals whose coverage is known: no distribution is assumed.
#pragma once

#include <optional>
#include <vector>

namespace podm::bench {

/// The coverage that an interval needs before a claim is decided by it.
inline constexpr double kConfidence = 0.95;

/// Holds the median of what is measured with the probability `coverage`, before anything is measured.
struct Interval {
  double low = 0, high = 0;
  double coverage = 0;
};

/// The interval from the k-th least to the k-th greatest of n independent samples. It misses the median when
/// fewer than k of them lie on one side, so that its coverage is 1 - 2 P(B < k), B binomial of n and 1/2:
/// exactly for a continuous distribution, at least for any other. The k is the greatest with the coverage
/// asked for, which makes the interval the narrowest; it depends on n alone, as a choice by the samples would
/// cost coverage. With too few samples it is 1, and the coverage what it then is: 96.9 % of six, 93.75 of
/// five, 75 of three, 0 of one.
Interval median_interval(std::vector<double> samples, double confidence = kConfidence);

/// The fewest samples that have the coverage: 6 for 95 %.
int fewest_samples(double confidence = kConfidence);

/// A number over another, both at least 0: 1 where both are 0, infinite over 0.
double ratio_of_numbers(double above, double below);

/// The ratio of the medians of two series that are independent of each other. Both are held with the square
/// root of the confidence, and the coverage, the product of theirs, is a lower bound.
Interval ratio_interval(const std::vector<double>& above, const std::vector<double>& below,
                        double confidence = kConfidence);

/// About how many samples keep the interval of 95 % on one side of the bound, if they go on to spread as they
/// do; at least fewest_samples(). The estimate is that for the median of normal samples. Nothing where one
/// sample shows no spread, the median lies on the bound, or the number is beyond any use.
std::optional<int> samples_needed(const std::vector<double>& samples, double bound);

}  // namespace podm::bench
