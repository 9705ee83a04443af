// Data that a run on ranks adds to its record and its summary.
#pragma once

#include "cli/commands/mesh_run.h"
#include "cli/processes/ranks_of_machine.h"
#include "distributed/mesh_image_on_ranks.h"

namespace podm::cli {

/// Gathers sums and lists over all ranks: facet pairs, the largest memory of a process, `ranks` and
/// `ranks_text`. The mesh is in `result`, and `threads` are this rank's. Collective.
void gather_from_ranks(const MeshingOnRanks& result, int threads, const RanksOfMachine& machines,
                       Communication& ranks, MeshRun& run);

}  // namespace podm::cli
