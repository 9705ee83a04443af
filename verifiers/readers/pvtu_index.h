// What the XML of a PVTU file tells: where the pieces of a mesh are.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "readers/mesh_file.h"

namespace podm::verify {

struct PieceSource {
  std::string path;
  std::size_t line = 0;  ///< of the index, which names it there

  std::string place() const;  ///< "line 12, Piece"
};

/// The pieces of an unstructured grid in the index's order, their paths as seen from here. Throws InputError,
/// with the line: no such index, no pieces, ghost cells, a piece that is named twice.
std::vector<PieceSource> parse_pvtu(const MeshFile& file);

}  // namespace podm::verify
