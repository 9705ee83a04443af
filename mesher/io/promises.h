// What mesh files say of an optimised mesh: what it does not keep of what every other mesh does, and what it
// keeps beside that. Others promise what all do, and their files say nothing.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

/// Words such as "unclaimed delaunay" and "dihedral 8 165", in the words of podm-verify.
inline std::vector<std::string> promises_of(const TetMesh& mesh) {
  std::vector<std::string> promises;
  if (mesh.is_optimized) promises.emplace_back("unclaimed delaunay");
  if (mesh.dihedral_bounds_deg)
    promises.push_back(
        fmt::format("dihedral {} {}", (*mesh.dihedral_bounds_deg)[0], (*mesh.dihedral_bounds_deg)[1]));
  return promises;
}

}  // namespace podm
