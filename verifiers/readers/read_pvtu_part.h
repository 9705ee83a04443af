// Reads a mesh in pieces on ranks: each rank reads its pieces only.
#pragma once

#include <string>

#include "mesh.h"
#include "ranks/communication.h"

namespace podm::verify {

/// Collective. Returns this rank's part of the mesh (ranks/part.h) that a .pvtu names, and of the facets in
/// "x_facets.pvtu" beside it. Ranks take pieces that follow one another. The faults that read_mesh() refuses
/// are refused here, too: throws RefusedByAll.
Mesh read_pvtu_part(const std::string& path, Communication& ranks);

}  // namespace podm::verify
