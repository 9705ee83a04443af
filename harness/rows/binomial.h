// The accuracy of a share that is estimated from a number of tries.
#pragma once

namespace podm::bench {

struct ShareInterval {
  double low = 0, high = 1;
};

/// Returns the interval of Clopper and Pearson. It holds the probability of a success with at least the given
/// confidence, whatever that probability is. Requires 0 <= num_successes <= num_tries; returns [0, 1] for no
/// tries.
ShareInterval clopper_pearson(int num_successes, int num_tries, double confidence = 0.95);

}  // namespace podm::bench
