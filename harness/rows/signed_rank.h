// The centre of a symmetric distribution, by ranks. Outliers move it little, and its interval is exact.
#pragma once

#include <span>

namespace podm::bench {

/// An estimate and the interval that holds the true value.
struct CentreEstimate {
  double value = 0, low = 0, high = 0;
};

/// Returns the Hodges-Lehmann estimate, which is the median of the means of all pairs of samples (including
/// each sample with itself), and the interval that Wilcoxon's signed-rank test does not reject (Hollander,
/// Wolfe and Chicken 2014, section 3.3). The interval holds the centre with at least the given confidence if
/// the samples are independent and symmetric about the centre. Both ends are infinite if there are too few
/// samples for the confidence. Requires at least one sample.
CentreEstimate signed_rank_estimate(std::span<const double> samples, double confidence);

}  // namespace podm::bench
