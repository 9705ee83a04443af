#include "rows/signed_rank.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "rows/order_statistics.h"

namespace podm::bench {
namespace {

// Returns the probabilities of the signed-rank statistic 0, 1, ...: each rank is in the sum with probability
// one half.
std::vector<double> signed_rank_distribution(std::size_t num_samples) {
  std::vector<double> probability(num_samples * (num_samples + 1) / 2 + 1, 0.0);
  probability[0] = 1;
  for (std::size_t rank = 1; rank <= num_samples; ++rank)
    for (std::size_t sum = probability.size(); sum-- > 0;)
      probability[sum] = (probability[sum] + (sum >= rank ? probability[sum - rank] : 0)) / 2;
  return probability;
}

// Returns the number of means of pairs that lie beyond each end of the interval, plus one; 0: no interval has
// the confidence.
std::size_t rank_of_end(std::size_t num_samples, double confidence) {
  static std::mutex mutex;
  static std::map<std::pair<std::size_t, double>, std::size_t> known;
  const std::scoped_lock lock(mutex);
  const auto [entry, is_new] = known.try_emplace({num_samples, confidence}, 0);
  if (!is_new) return entry->second;
  const std::vector<double> probability = signed_rank_distribution(num_samples);
  std::size_t rank = 0;
  for (double tail = probability[0]; tail <= (1 - confidence) / 2; tail += probability[rank]) ++rank;
  return entry->second = rank;
}

}  // namespace

CentreEstimate signed_rank_estimate(std::span<const double> samples, double confidence) {
  std::vector<double> means;
  means.reserve(samples.size() * (samples.size() + 1) / 2);
  for (std::size_t i = 0; i < samples.size(); ++i)
    for (std::size_t j = i; j < samples.size(); ++j) means.push_back((samples[i] + samples[j]) / 2);
  const auto ranked = [&means](std::size_t rank) {  // rank counts from 1
    const auto place = means.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(means.begin(), place, means.end());
    return *place;
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CentreEstimate estimate{.value = median(means), .low = -kInfinity, .high = kInfinity};
  if (const std::size_t rank = rank_of_end(samples.size(), confidence); rank > 0) {
    estimate.low = ranked(rank);
    estimate.high = ranked(means.size() + 1 - rank);
  }
  return estimate;
}

}  // namespace podm::bench
