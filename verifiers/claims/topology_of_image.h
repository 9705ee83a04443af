// The components of the labels of an image, with the handles and cavities of each, as a mesh may show them.
//
// Faces join voxels of a label. Two kinds of places are ambiguous, as the 6-connected and the 26-connected
// reading of the image differ there: an edge with two voxels of a label at opposite sides and none at the
// other two; and a corner around which the voxels of a label, or those of the rest, are in several pieces,
// although none of its edges is ambiguous. At ambiguous edges, and at corners with such pieces, the label
// goes on if the mesh has it there, and otherwise the rest.
//
// The Euler characteristic of a region counts voxels - faces + edges - corners of which all voxels are the
// region's, as in the complex with a point for each voxel. An ambiguous edge that is in the label adds a
// connection: -1. A corner that is in the label, with p pieces of it and q of the rest around it, adds q - p:
// the label on a small sphere around the corner has the Euler characteristic p - q + 1, as the curves between
// the pieces are p + q - 1.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "claims/region_graph.h"
#include "image/image.h"

namespace podm::verify {

/// Twice the voxel indices of an edge's middle or of a corner.
using HalfVoxel = std::array<int, 3>;

struct ImageRegionFacts {
  std::array<int, 3> low{}, high{};  ///< bounds, voxels
  std::uint64_t ambiguous = 0;       ///< places at it
  std::uint64_t parts = 0;           ///< that faces join
  std::uint32_t group = 0;           ///< one number for regions that ambiguous places would join
};

struct TopologyOfImage {
  std::vector<LabelRegion> regions;
  std::vector<ImageRegionFacts> facts;   ///< by region
  std::vector<std::uint32_t> region_of;  ///< by voxel; kNone for the background
  std::vector<std::uint32_t> part_of;    ///< by voxel: a voxel of the part that faces join
  /// All ambiguous places, each with its label.
  std::vector<std::pair<HalfVoxel, LabelValue>> ambiguous;
};

/// The places at which find_topology_of_image() asks for labels, sorted by z, y, x. It may leave out some.
std::vector<HalfVoxel> places_to_read(const Image& image);

/// `label_at` is the mesh's label at a place. Takes 28 bytes per voxel.
TopologyOfImage find_topology_of_image(const Image& image,
                                       const std::function<LabelValue(const HalfVoxel&)>& label_at);

}  // namespace podm::verify
