#include "algorithms/image_owners.h"

namespace podm {

ImageOwners owners_of_image(const LabelImage& image, const FeatureTransform& transform,
                            const PlacementOfTeam& placement, std::uint64_t seed, const PageQuery& query) {
  const std::span<const LabelIndex> labels(image.voxels);
  if (placement.is_real)
    return {MemoryOwners::ask(labels, placement.machine, query),
            MemoryOwners::ask(transform.words(), placement.machine, query)};
  constexpr unsigned kHugePage = 21;  // log2 of bytes, see parallel_resize.h and huge_array.h
  std::vector<NodeIndex> nodes;
  for (const Place& place : placement.places) nodes.push_back(static_cast<NodeIndex>(place.node));
  return {MemoryOwners::deal(labels, kHugePage, nodes, seed),
          MemoryOwners::deal(transform.words(), kHugePage, nodes, seed + 1)};
}

}  // namespace podm
