// Medians of repeated measurements and their accuracy.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace podm::bench {

/// Returns the median of at least one sample; for an even number, the mean of the middle two.
double median(std::vector<double> samples);

/// An estimate and the interval that holds the true value with the given confidence.
struct Ratio {
  double value = 1, low = 1, high = 1;
};

enum class Sampling {
  kPaired,       ///< sample i of both was taken at the same time and shares its disturbance
  kIndependent,  ///< no sample of one belongs to a sample of the other
};

struct BootstrapOptions {
  double confidence = 0.95;
  int num_resamples = 2000;
  std::uint64_t seed = 1;
};

/// Returns median(numerator) / median(denominator). All samples must be positive; paired series must have
/// equal lengths. The interval is the percentile bootstrap's; a paired resample draws pairs. The interval
/// holds the value, scales with the samples and is inverted when numerator and denominator are swapped. BCa
/// is not used: it needs the jackknife, which is inconsistent for a median (Efron and Tibshirani 1993,
/// section 11.6).
Ratio ratio_of_medians(std::span<const double> numerator, std::span<const double> denominator,
                       Sampling sampling, const BootstrapOptions& options = {});

}  // namespace podm::bench
