// A mesh as a VTU file a rank and an index of them: "x.pvtu" names x_0.vtu, x_1.vtu and so on,
// "x_facets.pvtu" their facets, x_0_facets.vtu. These are the steps; distributed/write_pieces.h takes them on
// all ranks.
#pragma once

#include <deque>
#include <string>

#include "files/atomic_file.h"
#include "podm/mesh_piece.h"

namespace podm {

/// The two files of a piece, as write_mesh() writes a .vtu and with the point array `GlobalNodeIds` (Int64),
/// a vertex's number in the whole mesh. They have no names until publish_together() gives them. Throws
/// InputError naming the file.
std::deque<AtomicFile> write_pvtu_piece(const MeshPiece& piece, const std::string& index_path);

/// Removes the index of an earlier mesh: while pieces are published, none may name those of two meshes.
/// Returns how many pieces it named; 0 if there was none, or none that we wrote.
int withdraw_pvtu_index(const std::string& path);

/// Writes the index of the cells and that of the facets. All pieces must have been published. Then removes
/// what an earlier mesh of more pieces has left.
void write_pvtu_index(const std::string& path, int num_pieces, int num_earlier_pieces);

}  // namespace podm
