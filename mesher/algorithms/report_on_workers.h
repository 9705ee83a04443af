// What workers did, as the public report tells it.
#pragma once

#include <vector>

#include "podm/meshing_report.h"
#include "refine/worker.h"
#include "runtime/placement.h"

namespace podm {

/// `machine` gives the hops between its nodes; none: one node.
template <class Locks>
Counters counters_of(const Worker<Locks>& worker, const Overhead& overhead, const Place& place,
                     const Topology* machine);

void add(const Counters& terms, Counters& sums);
Counters sum_of(const std::vector<WorkerReport>& workers);

}  // namespace podm
