// A mesh as one VTU file per rank and an index of them: "x.pvtu" lists x_0.vtu, x_1.vtu and so on,
// "x_facets.pvtu" lists their facets, x_0_facets.vtu. This file declares the steps;
// distributed/write_pieces.h performs them on all ranks.
#pragma once

#include <deque>
#include <string>

#include "files/atomic_file.h"
#include "podm/mesh_piece.h"

namespace podm {

/// Writes the two files of a piece as write_mesh() writes a .vtu, with the additional point array
/// `GlobalNodeIds` (Int64): a vertex's number in the whole mesh. The files have no names until
/// publish_together() is called. Throws InputError that names the file.
std::deque<AtomicFile> write_pvtu_piece(const MeshPiece& piece, const std::string& index_path);

/// Removes the index of an earlier mesh, because no index may list pieces of two meshes during publication.
/// Before that writes x.pvtu.unfinished, which lists the pieces of both. Returns the number of pieces of the
/// earlier mesh, also of one whose run was killed before its index was written; 0 if there was none, or none
/// that podm wrote. A run that is killed before it published a piece counts as well: files that have the
/// names of its pieces go with them.
int withdraw_pvtu_index(const std::string& path, int num_pieces);

/// Writes the index of the cells and that of the facets. All pieces must have been published. Then removes
/// the remaining pieces of an earlier mesh that had more pieces, what a killed run of more ranks has left of
/// its pieces, and x.pvtu.unfinished.
void write_pvtu_index(const std::string& path, int num_pieces, int num_earlier_pieces);

}  // namespace podm
