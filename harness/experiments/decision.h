// Decides whether a number lies within the bounds of a claim, as far as its repeats allow.
#pragma once

#include <optional>
#include <string>

#include "experiments/claim.h"
#include "rows/series.h"

namespace podm::bench {

/// The permitted values of a claim's number.
struct Bounds {
  std::optional<double> at_least, at_most;
  bool is_strict = false;  ///< `at_least` itself is too little

  bool contain(double value) const;
  /// Returns the distance of the value beyond the nearest bound, relative to the bound; below 0: within.
  double excess(double value) const;
};

/// Returns the bounds of a bound, a ratio, a share or an order. The bounds of a trend depend on its steps.
Bounds bounds_of(const Claim& claim);

enum class Outcome {
  kHolds,
  kFails,
  kNotResolved,  ///< the interval straddles a bound or has too little coverage, or other work disturbed the
                 ///< rows
};

struct Decision {
  Outcome outcome = Outcome::kNotResolved;
  std::string doubt;                 ///< the reason why it is not resolved
  std::optional<int> rounds_needed;  ///< number that would resolve it, if it can be estimated
  /// True if too few rounds are the only doubt and the median lies within the bounds.
  bool agrees_on_few_rounds = false;
};

/// Decides a number that varies by its interval, which needs a coverage of kConfidence and must lie on one
/// side of each bound. Decides a number that does not vary by its value. Rows that other work disturbed
/// resolve no number that varies.
Decision decide(const Bounds& bounds, const Estimate& estimate);

/// ", 0.98 to 1.14 holds the median with 96.9 % (6 rounds)"; empty without an interval.
std::string describe_interval(const Estimate& estimate);

/// "other work kept 1.2 processors busy".
std::string describe_disturbance(double busy);

}  // namespace podm::bench
