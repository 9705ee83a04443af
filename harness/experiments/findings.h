// The findings of rows about a claim, group by group. A group consists of rows of equal options, except the
// options that the claim compares.
#pragma once

#include <string>
#include <vector>

#include "experiments/decision.h"

namespace podm::bench {

/// The finding of one group of rows.
struct Finding {
  Decision decision;
  Estimate estimate;  ///< of the number that the bounds apply to
  double excess = 0;  ///< distance beyond the bound, relative to it; below 0: within
  std::string text;   ///< the numbers behind the decision
  std::string label;  ///< distinguishes the group; empty for a single group
  std::size_t num_rows = 0;
};

/// The findings of all groups.
struct Findings {
  std::vector<Finding> found;
  std::string missing;  ///< the first thing that a group lacks; empty: nothing
  bool has_failed_rows = false;
};

/// There is at least one row, and all `rows` have the claim's basis and match its filter.
Findings find(const Claim& claim, const RowPointers& rows);

}  // namespace podm::bench
