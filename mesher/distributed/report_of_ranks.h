// Combines the reports of all ranks into the report of the run.
#pragma once

#include <utility>
#include <vector>

#include "distributed/mesh_image_on_ranks.h"

namespace podm {

/// Returns the report of the whole run, as in MeshingOnRanks but without missing labels, and the parts by
/// rank. Each rank passes its own report and part. Collective.
std::pair<MeshingReport, std::vector<PartOfRank>> report_of_ranks(MeshingReport own, PartOfRank part,
                                                                  Communication& ranks);

}  // namespace podm
