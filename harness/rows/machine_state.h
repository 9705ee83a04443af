// What rows say of the machine that they were measured on.
#pragma once

#include "rows/row.h"

namespace podm::bench {

inline bool same_machine(const Row& a, const Row& b) {
  return static_cast<const MachineRecord&>(a.environment) == static_cast<const MachineRecord&>(b.environment);
}

}  // namespace podm::bench
