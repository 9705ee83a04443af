// Mesh files: VTU, medit .mesh, Gmsh .msh 4.1; surfaces as STL or PLY. Files appear whole or not at all.
#pragma once

#include <string>

#include "podm/tet_mesh.h"

namespace podm {

/// Brings the mesh into its canonical order: vertices by coordinates, each cell and facet rotated to start
/// at its smallest vertex, cells and facets sorted. Two runs that made the same mesh then agree byte by byte.
void canonicalize(TetMesh& mesh);

/// Lower-case hexadecimal SHA-256 of a canonical mesh: coordinates, cells, label values, facets.
std::string mesh_sha256(const TetMesh& mesh);

/// Throws InputError if `path` has no known mesh extension (.vtu .mesh .msh) or cannot be written.
void check_mesh_path(const std::string& path);
void check_surface_path(const std::string& path);  ///< .stl .ply

/// Writes the mesh in the format of the extension. Throws InputError naming the file and the fault.
void write_mesh(const TetMesh& mesh, const std::string& path);

/// Writes the closed, outward oriented surface of every label: "s.stl" becomes s_<value>[_<name>].stl.
/// Returns nothing; throws as write_mesh does.
void write_surfaces(const TetMesh& mesh, const std::string& path);

}  // namespace podm
