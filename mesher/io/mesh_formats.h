// The mesh file formats, one function each. write_mesh() calls them.
#pragma once

#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

using Losses = std::vector<std::string>;  ///< as write_mesh() returns them

/// VTK XML, appended raw binary: `path` holds the cells, `<stem>_facets.vtu` beside it the facets, and
/// `<stem>_lines.vtu` the lines if they were asked for. Reports such a file of another mesh.
Losses write_vtu(const TetMesh& mesh, const std::string& path);

/// XDMF, with the arrays in `<stem>.h5` beside it (io/write_xdmf.h).
void write_xdmf(const TetMesh& mesh, const std::string& path);

/// Medit ascii. Every coordinate has the fewest digits (at most 17) that read back to the same double.
void write_medit(const TetMesh& mesh, const std::string& path);

/// Gmsh MSH 4.1 binary.
void write_gmsh(const TetMesh& mesh, const std::string& path);

/// Gmsh MSH 2.2 text.
void write_gmsh_v2(const TetMesh& mesh, const std::string& path);

/// Abaqus input, which CalculiX reads, too.
Losses write_abaqus(const TetMesh& mesh, const std::string& path);

/// Exodus II, as netCDF of 64-bit offsets.
Losses write_exodus(const TetMesh& mesh, const std::string& path);

/// Legacy VTK binary: `path` holds the cells, `<stem>_facets.vtk` beside it the facets.
void write_legacy_vtk(const TetMesh& mesh, const std::string& path);

/// TetGen: .node, .ele and .face of the stem of `path`.
void write_tetgen(const TetMesh& mesh, const std::string& path);

}  // namespace podm
