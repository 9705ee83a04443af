// The virtual time that the counted work of attempts takes. The constants are in runtime/time_costs.h.
#pragma once

#include <cstdint>

#include "podm/counters.h"
#include "runtime/time_costs.h"

namespace podm {

/// Counted work of a worker, so far or between two points in time.
struct Work {
  std::uint64_t classified = 0, searches = 0, tests = 0, created = 0, planned = 0;

  Work operator-(const Work& b) const {
    return {classified - b.classified, searches - b.searches, tests - b.tests, created - b.created,
            planned - b.planned};
  }
};
inline Work work_of(const Counters& counters) {
  return {counters.classified_cells, counters.oracle_searches, counters.conflict_tests,
          counters.cells_created, counters.planned_cells};
}

/// Returns the seconds of an attempt with this work. An attempt takes locks if other workers may use the same
/// vertices.
double attempt_seconds(const Work& work, const TimeCosts& costs, bool takes_locks);

}  // namespace podm
