// Parts that the readers of a mesh in pieces share.
#pragma once

#include <string>
#include <vector>

#include "errors.h"
#include "mesh.h"
#include "readers/pvtu_index.h"

namespace podm::verify {

/// Calls read(file) for each piece. An error names the index, too.
template <class Read>
void for_each_piece(const MeshFile& index, const std::vector<PieceSource>& pieces, Read read) {
  for (const PieceSource& piece : pieces) {
    try {
      read(MeshFile(piece.path));
    } catch (const InputError& error) {
      index.refuse(piece.place(), error.what());
    }
  }
}

std::string text_of(const Point& point);  ///< "(1, 2.5, 0)"
std::string format_of_pieces(std::size_t num_pieces, const std::string& format_of_first);

/// Copies what the first piece states about the whole mesh: space, labels and promises.
void take_head(const Mesh& first, Mesh& whole);
/// Throws InputError unless a piece names the same labels and the same space as the first.
void check_labels_and_space(const MeshFile& file, const Mesh& piece, const Mesh& first);

}  // namespace podm::verify
