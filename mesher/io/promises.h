// The promises of a mesh in its file: for an optimised mesh, the claim of all other meshes that it does not
// keep; bounds on dihedral angles, if they were requested and reached; and the width by which interfaces were
// smoothed. Other meshes have no such words.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

/// Returns texts such as "unclaimed delaunay", "dihedral 8 165" and "smoothed 1.5", in the words of
/// podm-verify.
inline std::vector<std::string> promises_of(const TetMesh& mesh) {
  std::vector<std::string> promises;
  if (mesh.is_optimized) promises.emplace_back("unclaimed delaunay");
  if (mesh.dihedral_bounds_deg)
    promises.push_back(
        fmt::format("dihedral {} {}", (*mesh.dihedral_bounds_deg)[0], (*mesh.dihedral_bounds_deg)[1]));
  if (mesh.smoothing_mm > 0) promises.push_back(fmt::format("smoothed {}", mesh.smoothing_mm));
  return promises;
}

}  // namespace podm
