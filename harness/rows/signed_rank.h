// The centre of a symmetric distribution, by ranks: outliers move it little, and its interval is exact.
#pragma once

#include <span>

namespace podm::bench {

/// An estimate and the interval that holds the true value.
struct CentreEstimate {
  double value = 0, low = 0, high = 0;
};

/// The Hodges-Lehmann estimate, which is the median of the means of all pairs of samples (a sample with
/// itself among them), and the interval that Wilcoxon's signed-rank test does not reject (Hollander, Wolfe
/// and Chicken 2014, section 3.3). It holds the centre with at least the confidence asked for when the
/// samples are independent and symmetric about it; both ends are infinite where the samples are too few for
/// that. Asks for at least one sample.
CentreEstimate signed_rank_estimate(std::span<const double> samples, double confidence);

}  // namespace podm::bench
