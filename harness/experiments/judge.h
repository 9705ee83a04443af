// Whether rows bear out a claim.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/claim.h"
#include "rows/order_statistics.h"

namespace podm::bench {

enum class Verdict { kHolds, kDoesNotHold, kNotResolved, kCannotBeDecided };
/// "holds", "does_not_hold", "not_resolved", "cannot_be_decided".
std::string to_string(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::kCannotBeDecided;
  std::string reason;  ///< the group that the value is of and why it resolves nothing, or what is missing
  std::optional<double>
      value;  ///< that of the group that is nearest to breaking the claim, or breaks it most
  std::optional<Interval> interval;  ///< of that value; nothing where it is the same in each run
  std::size_t num_rounds = 0;        ///< behind the value
  std::optional<int> rounds_needed;  ///< that would resolve the claim, where they can be estimated
  std::vector<std::string> sizes;    ///< the patterns of the claim's trials that were judged
  std::size_t num_rows = 0;          ///< that were judged
};

/// `rows` are those of one experiment, as rows_to_judge() leaves them. Each pattern of the claim's trials is
/// a size of the experiment and is judged alone, if it has rows. The claim does not hold when one group of
/// equal options of any size breaks it, and holds when every group of the sizes does that have all rows which
/// it needs; at least one size has. A size whose rounds are too few to decide is set aside if its medians
/// agree and another size decides.
Judgement judge(const Claim& claim, const std::vector<Row>& rows);

}  // namespace podm::bench
