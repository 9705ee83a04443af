// Checks of a whole store.
#pragma once

#include <string>

#include "delaunay/mesh.h"

namespace podm {

/// True if adjacency and orientation hold: the part of is_valid() that holds for an optimised mesh.
bool is_triangulation(const Mesh& mesh, std::string* fault = nullptr);
/// True if adjacency, orientation, circumspheres and the local Delaunay property all hold; `fault` describes
/// the first violation. Linear in the number of cells.
bool is_valid(const Mesh& mesh, std::string* fault = nullptr);

}  // namespace podm
