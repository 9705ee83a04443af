#include "rows/order_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace podm::bench {
namespace {

constexpr int kMostSamples = 1000;  // a larger number is of no use

// Returns the coverage of the interval from the k-th least to the k-th greatest of n samples.
double coverage_of(std::size_t n, std::size_t k) {
  double probability = std::pow(0.5, static_cast<double>(n));  // that no sample lies on one side
  double missed = 0;
  for (std::size_t i = 0; i < k; ++i) {
    missed += probability;
    probability *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return std::max(0.0, 1 - 2 * missed);
}

// The median of n normal samples has this times their standard deviation over sqrt(n) as its standard
// deviation.
constexpr double kDeviationOfMedian = 1.2533;  // sqrt(pi / 2)
constexpr double kNormalQuantile = 1.96;       // of 97.5 %

double deviation_of(const std::vector<double>& samples) {
  const auto n = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / n;
  double squares = 0;
  for (const double sample : samples) squares += (sample - mean) * (sample - mean);
  return std::sqrt(squares / (n - 1));
}

}  // namespace

double median(std::vector<double> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return (*std::max_element(samples.begin(), middle) + *middle) / 2;
}

Interval median_interval(std::vector<double> samples, double confidence) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  std::size_t k = 1;
  while (2 * (k + 1) <= n && coverage_of(n, k + 1) >= confidence) ++k;
  return {samples[k - 1], samples[n - k], coverage_of(n, k)};
}

int fewest_samples(double confidence) {
  int n = 1;
  while (coverage_of(static_cast<std::size_t>(n), 1) < confidence) ++n;
  return n;
}

double ratio_of_numbers(double above, double below) {
  if (below != 0) return above / below;
  return above == 0 ? 1 : std::numeric_limits<double>::infinity();
}

Interval ratio_interval(const std::vector<double>& above, const std::vector<double>& below,
                        double confidence) {
  const double each = std::sqrt(confidence);
  const Interval a = median_interval(above, each), b = median_interval(below, each);
  return {ratio_of_numbers(a.low, b.high), ratio_of_numbers(a.high, b.low), a.coverage * b.coverage};
}

std::optional<int> samples_needed(const std::vector<double>& samples, double bound) {
  if (samples.size() < 2) return {};
  const double margin = std::abs(median(samples) - bound);
  const double roots = kNormalQuantile * kDeviationOfMedian * deviation_of(samples) / margin;
  const double needed = std::ceil(roots * roots);
  if (!(needed <= kMostSamples)) return {};  // also if it is not a number
  return std::max(fewest_samples(), static_cast<int>(needed));
}

}  // namespace podm::bench
