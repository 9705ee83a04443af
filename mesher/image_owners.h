// Which NUMA nodes the image and its feature transform lie on.
#pragma once

#include "algorithms/placement_of_team.h"
#include "image/feature_transform.h"
#include "runtime/numa_memory.h"

namespace podm {

/// Of a run on this machine's threads by asking `query`; of others by drawing a worker for each piece, as
/// long as one thread touches of it first: 1 MiB of labels, a huge page of the transform.
ImageOwners owners_of_image(const LabelImage& image, const FeatureTransform& transform,
                            const PlacementOfTeam& placement, std::uint64_t seed, const PageQuery& query);

}  // namespace podm
