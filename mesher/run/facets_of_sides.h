// The facets at the sides of a flat box.
#pragma once

#include <array>
#include <cstdint>

#include "delaunay/mesh.h"
#include "isosurface/isosurface.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// The number of facets whose dual edge leaves the object through a side of the box although not all of their
/// vertices are on that side. 0 if the box is open. `threads`: 0 for all cores.
std::uint64_t count_facets_off_sides(const Mesh& mesh, const Isosurface& isosurface, int threads);

/// True if the box is flat and the mesh is turned from the image's frame for output. Rounding may then leave
/// single vertices just inside circumspheres, so that the file does not claim to be Delaunay.
bool is_turned_for_output(const LabelImage& image);

/// The number of boundary facets on each side of the box.
std::array<std::uint64_t, kNumSides> count_facets_of_sides(const TetMesh& mesh);

}  // namespace podm
