// Medians of repeated measurements and how well they are known.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace podm::bench {

/// The median of at least one sample; that of an even number is the mean of the middle two.
double median(std::vector<double> samples);

/// An estimate and the interval that holds the truth with the confidence asked for.
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

/// median(numerator) / median(denominator), all samples positive; as many of both when paired. The interval
/// is the percentile bootstrap's, where a paired resample draws pairs. It holds the value, scales with the
/// samples and is inverted when they are swapped. It is not BCa: that needs the jackknife, which is
/// inconsistent for a median (Efron and Tibshirani 1993, section 11.6).
Ratio ratio_of_medians(std::span<const double> numerator, std::span<const double> denominator,
                       Sampling sampling, const BootstrapOptions& options = {});

}  // namespace podm::bench
