// The statements of the claim conformity about a schedule alone: leaves, rings and touched leaves.
#pragma once

#include <functional>

#include "claims/tally.h"
#include "schedule.h"

namespace podm::verify {

/// Calls add(name, tally) for each statement.
void check_schedule(const Schedule& schedule, const std::function<void(const char*, const Tally&)>& add);

}  // namespace podm::verify
