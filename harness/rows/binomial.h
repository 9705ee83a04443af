// How well a share is known from a number of tries.
#pragma once

namespace podm::bench {

struct ShareInterval {
  double low = 0, high = 1;
};

/// The interval of Clopper and Pearson: it holds the probability of a success with at least the confidence
/// asked for, whatever that probability is. Asks for 0 <= num_successes <= num_tries; [0, 1] without a try.
ShareInterval clopper_pearson(int num_successes, int num_tries, double confidence = 0.95);

}  // namespace podm::bench
