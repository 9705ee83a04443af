// One VTU file: its mesh, and the ids of its points in another mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

struct VtuGrid {
  Mesh mesh;                        ///< with ids of the file's own points
  std::vector<GlobalId> point_ids;  ///< one per point, from the array asked for; kNoId for other values
  std::string ids_place;            ///< "line 12, DataArray 'vertex'"
};

/// Returns the ids of the points as vertices of a mesh in memory; kNone for greater ids.
std::vector<VertexId> vertex_ids(const VtuGrid& grid);

/// `id_array` names the point array that `point_ids` come from; null: none. Throws InputError.
VtuGrid read_vtu_grid(const MeshFile& file, const char* id_array);

/// Returns the number of points of the file, after loading them to check that they exist. Throws InputError.
std::uint64_t count_vtu_points(const MeshFile& file);

/// True if the points are the same to the bit, also for NaN.
bool is_same_point(const Point& a, const Point& b);

/// Throws InputError unless every point equals the vertex of `mesh` that its id names.
void check_points(const MeshFile& file, const VtuGrid& grid, const Mesh& mesh);

/// These append the tetrahedra or the triangles of `grid` with their labels to `mesh`. `vertex_of` gives the
/// vertex for each point of the grid; a corner that is no point becomes kNone. They throw InputError if the
/// labels do not match those of the cells before.
void append_cells(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                  Mesh& mesh);
void append_facets(const MeshFile& file, const VtuGrid& grid, const std::vector<VertexId>& vertex_of,
                   Mesh& mesh);

}  // namespace podm::verify
