// Small readers of the written formats, made from the formats' descriptions alone. They throw
// std::runtime_error on unexpected input.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

std::string read_bytes(const std::string& path);

/// Returns the mesh of the file, with the label values and names of the file; background first.
TetMesh read_medit(const std::string& path);

/// A mesh and the signed surfaces around each volume. Surfaces are pairs of labels: {first, second} if the
/// surface's normal in the file points out of the volume, {second, first} if it points inwards.
struct GmshFile {
  TetMesh mesh;
  std::map<LabelIndex, std::vector<std::array<LabelIndex, 2>>> surfaces_of_volume;
};
GmshFile read_gmsh(const std::string& path);

/// Triangles of a surface, three points each.
using Triangles = std::vector<std::array<std::array<double, 3>, 3>>;
Triangles read_stl(const std::string& path);
Triangles read_ply(const std::string& path);

}  // namespace podm
