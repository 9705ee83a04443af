// The counts of workers for the public report.
#pragma once

#include <vector>

#include "podm/meshing_report.h"
#include "refine/worker.h"
#include "runtime/placement.h"

namespace podm {

/// Returns the accesses of a worker on node `own_node`, by hops.
HopsByKind hops_of(const std::optional<AccessTally>& accesses, int own_node, const Topology* machine);

/// `machine` gives the hops between its nodes; none: there is one node.
template <class Locks>
Counters counters_of(const Worker<Locks>& worker, const Overhead& overhead, const Place& place,
                     const Topology* machine) {
  Counters counters = worker.counters();
  counters.overhead = overhead;
  counters.hops = hops_of(worker.accesses(), place.node, machine);
  return counters;
}

void add(const Counters& terms, Counters& sums);
Counters sum_of(const std::vector<WorkerReport>& workers);

}  // namespace podm
