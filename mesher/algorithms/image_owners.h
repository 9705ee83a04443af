// The NUMA nodes that own the image and its feature transform.
#pragma once

#include "algorithms/placement_of_team.h"
#include "isosurface/feature_transform.h"
#include "runtime/numa_memory.h"

namespace podm {

/// Asks `query` for the owners if the workers are threads of this machine. Otherwise draws a worker for each
/// piece of the size that one thread touches first: a huge page.
ImageOwners owners_of_image(const LabelImage& image, const FeatureTransform& transform,
                            const PlacementOfTeam& placement, std::uint64_t seed, const PageQuery& query);

}  // namespace podm
