// Meshes from files of any format that podm-verify reads.
#pragma once

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm::cli {

struct ForeignMesh {
  std::string format;  ///< for messages: "Gmsh 4.1, binary"
  TetMesh mesh;        ///< with the facets that follow from its cells' labels
  /// A sentence for each property in which the file differs.
  std::vector<std::string> warnings;
};

/// Throws InputError that names the file, the place and the fault. Tetrahedra that do not meet in faces, and
/// labels that are not in [0, 2^32), are faults, too.
ForeignMesh read_foreign_mesh(const std::string& path);

}  // namespace podm::cli
