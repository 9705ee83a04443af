// Turns the store into the output mesh: the cells whose circumcenter lies inside, and the facets between
// labels, in world coordinates. `threads`: 0 for all cores; the result is the same for any number.
#pragma once

#include <cstdint>
#include <functional>

#include "delaunay/mesh.h"
#include "isosurface/isosurface.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Returns the number of cells with a label. Afterwards mesh.label() is known for all cells; dead cells have
/// the background's.
std::uint64_t label_cells(Mesh& mesh, const Isosurface& isosurface, int threads);

/// Consumes the store, whose memory is freed as the mesh grows. Besides the store the two take only 4 bytes
/// per vertex, 2 per cell of the store, 32 per boundary facet and a sixteenth of the mesh. `space` is kRas or
/// kLps. `facets_off_isosurface` becomes the number of boundary facets with a vertex off the isosurface.
/// `lines` has vertices by their ids in the store. Vertices and cells keep the order of their ids.
/// `is_wanted`, if given, selects from the cells with a label: all other cells and their facets are left out.
/// A facet between two labels belongs to the cell of the larger label.
using CellFilter = std::function<bool(CellId)>;
TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, Space space, int threads,
                     std::uint64_t& facets_off_isosurface, const CellFilter& is_wanted = {},
                     MeshLines lines = {});

/// Replaces RAS coordinates by continuous voxel indices.
void convert_to_voxel_space(TetMesh& mesh, const LabelImage& image, int threads);

}  // namespace podm
