// Joint writing of a mesh that no rank holds as a whole. Each rank writes its piece; nothing is gathered.
#pragma once

#include <string>

#include "distributed/communication.h"
#include "podm/mesh_piece.h"

namespace podm {

/// Throws InputError unless the path is .pvtu, .xdmf or .vtkhdf, the formats that ranks write together, and
/// this rank can write there.
void check_pieces_path(const std::string& path);

/// Writes the format of the path's extension. Collective. Throws RefusedByAll
/// (distributed/collective_errors.h) that names the file if any rank cannot write. Nothing new is left in
/// that case, and an earlier mesh remains unless its pieces were being replaced.
void write_pieces(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes x.pvtu and its pieces (io/write_pvtu.h). No piece gets its name before all pieces are on the disks,
/// nor while an index of an earlier mesh names it. The new index comes last. An index that exists therefore
/// always names all pieces of one mesh. Collective, and throws as write_pieces() does.
void write_pvtu(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes x.xdmf and x.h5 (io/write_xdmf.h). Rank 0 makes a temporary file of arrays without values. All
/// ranks write their rows at once, without the HDF5 library, which would need a version for MPI. The file
/// gets its name when it is complete. Collective, and throws as write_pieces() does.
void write_xdmf(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes x.vtkhdf and x_facets.vtkhdf (io/write_vtkhdf.h), all ranks at once, as write_xdmf() does.
/// Collective, and throws as write_pieces() does.
void write_vtkhdf(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Writes one closed surface per label, as write_surfaces() of podm/mesh_io.h does on one machine. All ranks
/// write to each file at once. The files get their names together when they are complete. Collective. Throws
/// RefusedByAll as write_pieces() does, also if the format cannot number the vertices or facets of a label.
void write_surfaces(const MeshPiece& piece, const std::string& path, Communication& ranks);

/// Returns the text of the first rank. Collective.
std::string text_of_first_rank(const std::string& text, Communication& ranks);

}  // namespace podm
