#include "rows/binomial.h"

#include <cmath>

namespace podm::bench {
namespace {

// Returns the probability of at least this number of successes. It grows with `share`, which lies in (0, 1).
double at_least(int num_successes, int num_tries, double share) {
  double sum = 0;
  for (int k = num_successes; k <= num_tries; ++k)
    sum += std::exp(std::lgamma(num_tries + 1) - std::lgamma(k + 1) - std::lgamma(num_tries - k + 1) +
                    k * std::log(share) + (num_tries - k) * std::log1p(-share));
  return sum;
}

// Returns the share at which at least this number of successes has the given probability.
double share_where(int num_successes, int num_tries, double probability) {
  double low = 0, high = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (at_least(num_successes, num_tries, middle) < probability ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

ShareInterval clopper_pearson(int num_successes, int num_tries, double confidence) {
  const double tail = (1 - confidence) / 2;
  ShareInterval interval;
  if (num_successes > 0) interval.low = share_where(num_successes, num_tries, tail);
  if (num_successes < num_tries) interval.high = share_where(num_successes + 1, num_tries, 1 - tail);
  return interval;
}

}  // namespace podm::bench
