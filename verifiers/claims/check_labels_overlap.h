// The volume of each label, and its overlap between mesh and image.
#pragma once

#include <map>
#include <vector>

#include "image/image.h"
#include "mesh.h"

namespace podm::verify {

struct LabelOverlap {
  std::uint64_t image_voxels = 0;
  std::uint64_t mesh_voxels = 0;  ///< voxels of the grid whose center lies in a cell of the label
  std::uint64_t both = 0;
  double mesh_mm3 = 0;  ///< sum of the cells' volumes, in extended precision

  double dice() const {
    return 2 * static_cast<double>(both) / static_cast<double>(image_voxels + mesh_voxels);
  }
};

/// `points` are the vertices in the image frame (voxel indices times spacing). A center on a facet belongs to
/// the later cell of those that have the facet, whatever the number of threads and ranks. The background is
/// left out. Collective.
std::map<LabelValue, LabelOverlap> find_overlaps(const Mesh& mesh, const Image& image,
                                                 const std::vector<Point>& points, double voxel_volume_mm3,
                                                 int threads);

}  // namespace podm::verify
