// Which NUMA nodes the image and its feature transform lie on.
#pragma once

#include "algorithms/placement_of_team.h"
#include "isosurface/feature_transform.h"
#include "runtime/numa_memory.h"

namespace podm {

/// Asks `query` for the owners where the run is on this machine's threads. For other runs it draws a worker
/// for each piece, of the size that one thread touches first: a huge page.
ImageOwners owners_of_image(const LabelImage& image, const FeatureTransform& transform,
                            const PlacementOfTeam& placement, std::uint64_t seed, const PageQuery& query);

}  // namespace podm
