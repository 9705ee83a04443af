// A mesh that no rank holds whole is written by all of them, each its piece: nothing is gathered.
#pragma once

#include <string>

#include "distributed/communication.h"
#include "podm/mesh_piece.h"

namespace podm {

/// Throws InputError unless it is .pvtu or .xdmf, which ranks write together, and this rank can write there.
void check_pieces_path(const std::string& path);

/// Writes the format that the path asks for. Collective. Throws RefusedByAll (distributed/together.h) naming
/// the file if any rank cannot write; nothing is left then, and an earlier mesh is there unless its pieces
/// were being replaced.
void write_pieces(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes x.pvtu and its pieces (io/write_pvtu.h). No piece gets its name before all are on the disks, and
/// none while an index of an earlier mesh names it; the new index comes last. So an index names all pieces of
/// one mesh whenever there is one. Collective, and throws as write_pieces() does.
void write_pvtu(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes x.xdmf and x.h5 (io/write_xdmf.h): the ranks add their rows one after the other to a file without a
/// name, which gets it when all is there. Collective, and throws as write_pieces() does.
void write_xdmf(const MeshPiece& piece, const std::string& path, Communication& ranks);

}  // namespace podm
