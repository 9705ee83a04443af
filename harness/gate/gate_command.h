// What `podm-bench gate` and `podm-bench compare` do. Both return the exit code and throw InputError.
#pragma once

#include <string>

#include "gate/gate.h"

namespace podm::bench {

/// Judges the head; with `renews`, puts what the head does into the file of budgets instead.
int run_gate(const GateOptions& options, bool renews);
/// Two files of records, before and after.
int compare_files(const std::string& before, const std::string& after);

}  // namespace podm::bench
