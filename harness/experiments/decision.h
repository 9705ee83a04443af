// Whether a number lies within the bounds of a claim, as far as repeats of it can say.
#pragma once

#include <optional>
#include <string>

#include "experiments/claim.h"
#include "rows/series.h"

namespace podm::bench {

/// What the number of a claim may be.
struct Bounds {
  std::optional<double> at_least, at_most;
  bool is_strict = false;  ///< `at_least` itself is too little

  bool contain(double value) const;
  /// How far beyond the nearest bound the value lies, relative to it; below 0: within.
  double excess(double value) const;
};

/// The bounds of a bound, a ratio, a share or an order; those of a trend are up to its steps.
Bounds bounds_of(const Claim& claim);

enum class Outcome {
  kHolds,
  kFails,
  kNotResolved,  ///< the interval straddles a bound, has too little coverage, or other work disturbed the
                 ///< rows
};

struct Decision {
  Outcome outcome = Outcome::kNotResolved;
  std::string doubt;                 ///< why it is not resolved
  std::optional<int> rounds_needed;  ///< that would resolve it, where they can be estimated
  /// Too few rounds are the only doubt, and the median lies within the bounds.
  bool agrees_on_few_rounds = false;
};

/// What varies is decided by its interval, which needs a coverage of kConfidence and has to lie on one side
/// of each bound; what does not, by the value. Rows that other work disturbed resolve nothing that varies.
Decision decide(const Bounds& bounds, const Estimate& estimate);

/// ", 0.98 to 1.14 holds the median with 96.9 % (6 rounds)"; empty without an interval.
std::string describe_interval(const Estimate& estimate);

/// "other work kept 1.2 processors busy".
std::string describe_disturbance(double busy);

}  // namespace podm::bench
