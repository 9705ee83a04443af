// One VTU file: its mesh, and what its points are called elsewhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

struct VtuGrid {
  Mesh mesh;                        ///< with ids of the file's own points
  std::vector<VertexId> point_ids;  ///< one a point, from the array asked for; kNone for what is no id
  std::string ids_place;            ///< "line 12, DataArray 'vertex'"
};

/// `id_array` names the point array that `point_ids` come from; null: none. Throws InputError.
VtuGrid read_vtu_grid(const MeshFile& file, const char* id_array);

/// How many points the file has, which are there. Throws InputError.
std::uint64_t count_vtu_points(const MeshFile& file);

/// Whether the points are the same to the bit, NaN too.
bool is_same_point(const Point& a, const Point& b);

/// Throws InputError unless every point lies where the vertex of `mesh` does that its id names.
void check_points(const MeshFile& file, const VtuGrid& grid, const Mesh& mesh);

/// Append the tetrahedra or the triangles of `grid` with their labels to `mesh`, `vertex_of` telling which
/// vertex each of the grid's points is; a corner that is no point becomes kNone. Throw InputError where the
/// labels are not as those of the cells before.
void append_cells(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                  Mesh& mesh);
void append_facets(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                   Mesh& mesh);

}  // namespace podm::verify
