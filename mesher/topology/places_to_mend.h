// The voxels around which a mesh must become finer to mend differences of topology.
//
//   lost             the component's voxels
//   spurious, split  the bounds of the mesh's pieces, except of the largest one
//   all others       the voxels whose labels in image and mesh differ, and which keep that difference when
//                    the image is deformed towards the mesh: voxel by voxel takes the mesh's label at its
//                    center, if that does not change the topology of the label (simple_voxel.h; "warping",
//                    Jain et al., CVPR 2010). Without any such voxel, as the difference is smaller than
//                    voxels, all that differ in the component's bounds; and without these, the component's
//                    voxels that are beside another label.
#pragma once

#include <cstddef>
#include <vector>

#include "topology/compare_topology.h"

namespace podm {

struct PlacesToMend {
  std::size_t difference;           ///< its number
  std::vector<std::size_t> voxels;  ///< their numbers in the image; at least one
};

/// Leaves out ambiguous differences.
std::vector<PlacesToMend> places_to_mend(const std::vector<RegionDifference>& differences, const Mesh& mesh,
                                         const MeshRegions& of_mesh, const LabelImage& image,
                                         const ImageRegions& of_image);

}  // namespace podm
