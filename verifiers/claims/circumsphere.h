// A cell's circumsphere in an image, rounded, however flat the cell is.
#pragma once

#include <optional>

#include "claims/voxel_map.h"
#include "geometry/measures.h"

namespace podm::verify {

struct Circumsphere {
  Point voxel;    ///< the circumcenter: each coordinate errs by less than 1e-9, or by an ulp
  double radius;  ///< in the mesh's coordinates; errs by less than 1e-9 of itself
};

/// Returns nothing if the cell is flat, or if its circumsphere is beyond all doubles.
std::optional<Circumsphere> circumsphere(const CellPoints& p, const VoxelMap& to_voxels);

}  // namespace podm::verify
