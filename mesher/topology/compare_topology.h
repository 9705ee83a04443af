// Compares the topology of each label in a mesh with that in the image.
//
// A region of the mesh matches the region of the image with its label that most of its cells' centroids are
// in. What differs:
//   lost       a part of a region of the image, joined by faces, that has no centroid of a cell of its label
//   joined     a region of the image that matches none, as one that matches another has centroids in it
//   spurious   a region of the mesh without a centroid in its label
//   split      a region of the image that several regions match
//   handles    a region with another number of handles than the only region that matches it
//   cavities   a region with another number of cavities than the only region that matches it
// Regions of the image are those that follow the mesh at ambiguous places (image_regions.h). A difference
// that these places can explain is *ambiguous*: two joined regions which such places would join; numbers
// that differ by no more than there are ambiguous places at the region; a spurious region at an ambiguous
// place, which is one of at most two voxels along each axis, with an ambiguous place of its label within half
// a voxel of its bounds; a region split into no more pieces than those of it that faces join, without pieces
// at an ambiguous place but the largest. It is counted, and no fault of the mesh.
#pragma once

#include <vector>

#include "podm/topology_report.h"
#include "topology/image_regions.h"
#include "topology/mesh_regions.h"

namespace podm {

/// A difference, and the regions that have it.
struct RegionDifference {
  TopologyDifference kind = TopologyDifference::kLost;
  bool is_ambiguous = false;
  std::uint32_t image_region = ImageRegions::kNone;  ///< kNone: spurious
  std::uint32_t part = ImageRegions::kNone;          ///< that is lost
  std::vector<std::uint32_t> mesh_regions = {};      ///< of the mesh, the largest first; empty: lost
};

/// Sorted by kind, then by region.
std::vector<RegionDifference> compare_topology(const Mesh& mesh, const MeshRegions& of_mesh,
                                               const LabelImage& image, const ImageRegions& of_image);

}  // namespace podm
