// The readers behind read_mesh(), one per format. Each throws InputError with file, place and fault.
#pragma once

#include "mesh.h"
#include "readers/mesh_file.h"

namespace podm::verify {

Mesh read_vtu(const MeshFile& file);
/// Adds to `mesh` the facets of the file that podm writes beside the file of the cells. Its triangles have
/// points of their own; the point array "vertex" gives the vertex of the mesh for each point.
void read_vtu_facets(const MeshFile& file, Mesh& mesh);
/// Both read a mesh in pieces: the VTU files that the index names.
Mesh read_pvtu(const MeshFile& index);
void read_pvtu_facets(const MeshFile& index, Mesh& mesh);
/// read_legacy_vtk_facets() adds the facets of the file beside the file of the cells, as read_vtu_facets()
/// does.
Mesh read_legacy_vtk(const MeshFile& file);
void read_legacy_vtk_facets(const MeshFile& file, Mesh& mesh);
Mesh read_medit(const MeshFile& file);
Mesh read_medit_binary(const MeshFile& file);
Mesh read_gmsh(const MeshFile& file);
Mesh read_abaqus(const MeshFile& file);
Mesh read_exodus(const MeshFile& file);
/// `faces` may be null: the facets are then unknown.
Mesh read_tetgen(const MeshFile& nodes, const MeshFile& elements, const MeshFile* faces);

}  // namespace podm::verify
