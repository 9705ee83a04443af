// What all ranks tell of a run becomes what the run tells of itself.
#pragma once

#include <utility>
#include <vector>

#include "distributed/mesh_image_on_ranks.h"

namespace podm {

/// The report of the whole, as MeshingOnRanks has it but for missing labels, and the parts by rank, from each
/// rank's own. Collective.
std::pair<MeshingReport, std::vector<PartOfRank>> report_of_ranks(MeshingReport own, PartOfRank part,
                                                                  Communication& ranks);

}  // namespace podm
