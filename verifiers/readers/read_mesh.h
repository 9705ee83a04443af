// The entry point for mesh files of any format.
#pragma once

#include <string>

#include "mesh.h"

namespace podm::verify {

/// Reads a mesh by its extension, which ".gz" may follow, and checks that the content agrees. The extensions
/// are .vtu, .pvtu (the pieces become one mesh), .vtk, .mesh, .meshb, .msh (2.2, 4.1), .inp (Abaqus), .e,
/// .exo, .ex2 or .g (Exodus II), and .node or .ele (each finds the other). The facets of "x.vtu" and "x.vtk"
/// are read from "x_facets.vtu" or "x_facets.vtk" beside it if that exists, those of "x.pvtu" from the pieces
/// of "x_facets.pvtu". Throws InputError with file, place and fault. Memory stays within a small multiple of
/// the file's (uncompressed) size, whatever its counts are.
Mesh read_mesh(const std::string& path);

}  // namespace podm::verify
