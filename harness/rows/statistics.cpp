#include "rows/statistics.h"

#include <algorithm>
#include <random>

namespace podm::bench {
namespace {

using Random = std::mt19937_64;
using Draw = std::vector<std::size_t>;  // indices of samples

void draw_from(std::size_t num_samples, Random& random, Draw& draw) {
  std::uniform_int_distribution<std::size_t> any(0, num_samples - 1);
  draw.resize(num_samples);
  for (std::size_t& index : draw) index = any(random);
}

double median_of(std::span<const double> samples, const Draw& draw) {
  std::vector<double> drawn;
  drawn.reserve(draw.size());
  for (const std::size_t index : draw) drawn.push_back(samples[index]);
  return median(std::move(drawn));
}

}  // namespace

double median(std::vector<double> samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return (*std::max_element(samples.begin(), middle) + *middle) / 2;
}

Ratio ratio_of_medians(std::span<const double> numerator, std::span<const double> denominator,
                       Sampling sampling, const BootstrapOptions& options) {
  Random random(options.seed);
  Draw above, below;
  std::vector<double> ratios(static_cast<std::size_t>(options.num_resamples));
  for (double& ratio : ratios) {
    draw_from(numerator.size(), random, above);
    if (sampling == Sampling::kIndependent) draw_from(denominator.size(), random, below);
    ratio =
        median_of(numerator, above) / median_of(denominator, sampling == Sampling::kPaired ? above : below);
  }
  std::sort(ratios.begin(), ratios.end());
  const double tail = (1 - options.confidence) / 2;
  const auto num_beyond = static_cast<std::size_t>(tail * static_cast<double>(ratios.size()));
  const double value =
      median({numerator.begin(), numerator.end()}) / median({denominator.begin(), denominator.end()});
  // A skewed distribution of resamples may lie on one side of the value.
  return {value, std::min(value, ratios[num_beyond]),
          std::max(value, ratios[ratios.size() - 1 - num_beyond])};
}

}  // namespace podm::bench
