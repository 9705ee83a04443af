// Meshes from files of any format that podm-verify reads.
#pragma once

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm::cli {

struct ForeignMesh {
  std::string format;  ///< for people: "Gmsh 4.1, binary"
  TetMesh mesh;        ///< with the facets that its cells' labels ask for
  /// A sentence for each thing that the file has otherwise.
  std::vector<std::string> warnings;
};

/// Throws InputError naming the file, the place and the fault: also for what is no mesh of tetrahedra that
/// meet in faces, and for labels that are not in [0, 2^32).
ForeignMesh read_foreign_mesh(const std::string& path);

}  // namespace podm::cli
