// The one door to mesh files of any format.
#pragma once

#include <string>

#include "mesh.h"

namespace podm::verify {

/// Reads a mesh by its extension (".gz" after it is allowed) and checks that the content agrees: .vtu, .pvtu
/// (the pieces that it names become one mesh), .vtk, .mesh, .meshb, .msh (2.2, 4.1), .inp (Abaqus), .e, .exo,
/// .ex2 or .g (Exodus II), .node or .ele (each finds the other). For "x.vtu" and "x.vtk", facets are read
/// from "x_facets.vtu" or "x_facets.vtk" beside it where that exists, and for "x.pvtu" from the pieces of
/// "x_facets.pvtu". Throws InputError with file, place and fault; memory stays within a small multiple of the
/// file's (uncompressed) size whatever its counts say.
Mesh read_mesh(const std::string& path);

}  // namespace podm::verify
