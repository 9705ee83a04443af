// The performance gate decides whether a change of the mesher may be merged. A difference in deterministic
// work always blocks, seconds block with evidence, and scaling is printed as advice. ci/README.md states the
// rule and its error rates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

inline constexpr const char* kBudgetsPath = "ci/gate_budgets.json";  ///< the default

struct GateOptions {
  std::string head;  ///< the changed mesher; a podm-verify lies beside it
  std::string base;  ///< the mesher before the change; empty: seconds are not compared
  std::string budgets_path = kBudgetsPath;
  std::vector<int> tiers{1, 2, 3};  ///< the tiers to pass
  std::uint64_t order_seed = 1;     ///< seed of the order within rounds
};

/// Prints the findings to standard output. Returns true if the change may be merged. Throws InputError, also
/// when the user stops the gate.
bool gate(const GateOptions& options, const StopQuery& stop_requested);

/// Replaces the budgets in the file by the head's current work. Throws InputError, and writes nothing, when a
/// claim about a mesh is not met.
void renew_budgets(const GateOptions& options, const StopQuery& stop_requested);

}  // namespace podm::bench
