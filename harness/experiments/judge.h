// Judges a claim by rows.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "experiments/claim.h"
#include "rows/order_statistics.h"

namespace podm::bench {

enum class Verdict { kHolds, kDoesNotHold, kNotResolved, kCannotBeDecided };
constexpr std::array<const char*, 4> names_of(Verdict) {
  return {"holds", "does_not_hold", "not_resolved", "cannot_be_decided"};
}

struct Judgement {
  Verdict verdict = Verdict::kCannotBeDecided;
  std::string reason;           ///< the group of the value and why it is not resolved, or what is missing
  std::optional<double> value;  ///< of the group that breaks the claim most, or is nearest to breaking it
  std::optional<Interval> interval;  ///< of that value; unset if the value is the same in each run
  std::size_t num_rounds = 0;        ///< behind the value
  std::optional<int> rounds_needed;  ///< number that would resolve the claim, if it can be estimated
  std::vector<std::string> sizes;    ///< the judged patterns of the claim's trials
  std::size_t num_rows = 0;          ///< number of judged rows
};

/// Judges a claim by the rows of one experiment that rows_to_judge() returns. Each pattern of the claim's
/// trials is a size of the experiment and is judged alone, if it has rows. The claim does not hold if one
/// group of equal options breaks it at any size. It holds if at least one size has all the rows that it needs
/// and every group of these sizes holds. A size with too few rounds to decide is set aside if its medians
/// agree and the claim holds at another size.
Judgement judge(const Claim& claim, const std::vector<Row>& rows);

}  // namespace podm::bench
