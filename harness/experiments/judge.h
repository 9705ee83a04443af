// Whether rows bear out a claim.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/claim.h"

namespace podm::bench {

enum class Verdict { kHolds, kDoesNotHold, kCannotBeDecided };
/// "holds", "does_not_hold", "cannot_be_decided".
std::string to_string(Verdict verdict);

struct Judgement {
  Verdict verdict = Verdict::kCannotBeDecided;
  std::string reason;  ///< the group that the value is of, or what is missing
  std::optional<double>
      value;                 ///< that of the group that is nearest to breaking the claim, or breaks it most
  std::size_t num_rows = 0;  ///< that were judged
};

/// `rows` are those of one experiment, as rows_to_judge() leaves them. A claim holds when it does in every
/// group of equal options; it cannot be decided when a group lacks rows or has failed ones, unless another
/// group already breaks it.
Judgement judge(const Claim& claim, const std::vector<Row>& rows);

}  // namespace podm::bench
