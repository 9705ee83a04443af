// The content of a PVTU file's XML: the paths of the pieces of a mesh.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "readers/mesh_file.h"

namespace podm::verify {

struct PieceSource {
  std::string path;
  std::size_t line = 0;  ///< line of the index that names the piece

  std::string place() const;  ///< "line 12, Piece"
};

/// Returns the pieces of an unstructured grid in the index's order; their paths include the index's folder.
/// Throws InputError with the line if it is no such index, has no pieces, has ghost cells, or names a piece
/// twice.
std::vector<PieceSource> parse_pvtu(const MeshFile& file);

}  // namespace podm::verify
