// From the store to the mesh that leaves the library: cells whose circumcentre lies inside, facets between
// labels, world coordinates.
#pragma once

#include <cstdint>

#include "delaunay/mesh.h"
#include "image/isosurface.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Cells with a label, without the boundary facets off the isosurface.
std::uint64_t count_labelled_cells(Mesh& mesh, const Isosurface& isosurface);

/// `space` is kRas or kLps. `facets_off_isosurface` counts boundary facets with a vertex elsewhere.
TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, const LabelImage& image, Space space,
                     std::uint64_t& facets_off_isosurface);

/// Replaces RAS coordinates by continuous voxel indices.
void convert_to_voxel_space(TetMesh& mesh, const LabelImage& image);

}  // namespace podm
