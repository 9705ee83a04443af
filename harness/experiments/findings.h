// What rows say of a claim, group by group. A group is rows of equal options but for those that the claim
// compares.
#pragma once

#include <string>
#include <vector>

#include "experiments/decision.h"

namespace podm::bench {

/// One group of rows against the claim.
struct Finding {
  Decision decision;
  Estimate estimate;  ///< of the number that the bounds are for
  double excess = 0;  ///< how far beyond the bound, relative to it; below 0: within
  std::string text;   ///< the numbers behind it
  std::string label;  ///< tells the group from others; empty for one alone
  std::size_t num_rows = 0;
};

/// What some rows say of a claim.
struct Findings {
  std::vector<Finding> found;
  std::string missing;  ///< the first thing that a group lacks; empty: nothing
  bool has_failed_rows = false;
};

/// `rows` are all of the claim's basis and filter, and at least one.
Findings find(const Claim& claim, const RowPointers& rows);

}  // namespace podm::bench
