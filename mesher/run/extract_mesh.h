// The store becomes the mesh that leaves the library: cells whose circumcentre lies inside, facets between
// labels, in the world. `threads`: 0 for all cores; the result is the same for any number.
#pragma once

#include <cstdint>
#include <functional>

#include "delaunay/mesh.h"
#include "isosurface/isosurface.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Cells with a label. Afterwards mesh.label() is known of all cells, the background's of dead ones.
std::uint64_t label_cells(Mesh& mesh, const Isosurface& isosurface, int threads);

/// Uses the store up: it gives its memory back as the mesh grows, so that both together take 4 bytes a
/// vertex, 2 a cell of the store, 32 a boundary facet and a sixteenth of the mesh more than the store.
/// `space` is kRas or kLps. `facets_off_isosurface` counts boundary facets with a vertex elsewhere. Vertices
/// and cells keep the order of their ids. `is_wanted`, if given, tells which of the cells with a label:
/// others and their facets are left out. A facet between labels is the cell's of the larger one.
using CellFilter = std::function<bool(CellId)>;
TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, Space space, int threads,
                     std::uint64_t& facets_off_isosurface, const CellFilter& is_wanted = {});

/// Replaces RAS coordinates by continuous voxel indices.
void convert_to_voxel_space(TetMesh& mesh, const LabelImage& image, int threads);

}  // namespace podm
