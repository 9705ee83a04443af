// The performance gate: may a change of the mesher go in? Deterministic work blocks always, seconds block
// with evidence, scaling advises. ci/README.md tells the rule and how often it errs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

inline constexpr const char* kBudgetsPath = "ci/gate_budgets.json";  ///< unless told otherwise

struct GateOptions {
  std::string head;  ///< the changed mesher; a podm-verify lies beside it
  std::string base;  ///< the mesher before the change; empty: no seconds are compared
  std::string budgets_path = kBudgetsPath;
  std::vector<int> tiers{1, 2, 3};  ///< those to pass
  std::uint64_t order_seed = 1;     ///< draws the order within rounds
};

/// Prints what was found to standard output; whether the change may go in. Throws InputError, also when the
/// user stops it.
bool gate(const GateOptions& options, const StopQuery& stop_requested);

/// Puts what the head does now into the file of budgets. Throws InputError, and writes nothing, when a claim
/// about a mesh is not met.
void renew_budgets(const GateOptions& options, const StopQuery& stop_requested);

}  // namespace podm::bench
