// The mesh file formats, one function each, all behind write_mesh().
#pragma once

#include <string>

#include "podm/tet_mesh.h"

namespace podm {

/// VTK XML, appended raw binary: `path` holds the cells, `<stem>_facets.vtu` beside it the facets.
void write_vtu(const TetMesh& mesh, const std::string& path);

/// XDMF, and the arrays in `<stem>.h5` beside it (io/write_xdmf.h).
void write_xdmf(const TetMesh& mesh, const std::string& path);

/// Medit ascii, every coordinate in the fewest digits (at most 17) that read back to the same double.
void write_medit(const TetMesh& mesh, const std::string& path);

/// Gmsh MSH 4.1 binary.
void write_gmsh(const TetMesh& mesh, const std::string& path);

}  // namespace podm
