// The files of a checkpoint: one piece of vertices per rank, and a text that lists the pieces and the facts
// of the run. A Delaunay triangulation whose ties are broken by coordinates is a function of its vertices.
// Therefore a checkpoint needs no cells.
//
//   Piece  kPieceMagic; the number n of vertices, 64 bits; n points of three doubles; n kinds of one byte.
//   Text   Lines "name: value". The last line has the SHA-256 of those above it.
//
// Text and pieces are refused unless every byte is as it was written: the text has the size and the SHA-256
// of each piece.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "distributed/collective_errors.h"
#include "distributed/learner.h"

namespace podm {

struct CheckpointPiece {
  std::uint64_t vertices = 0, bytes = 0;
  std::string sha256;
  bool operator==(const CheckpointPiece&) const = default;
};

struct CheckpointText {
  std::vector<Fact> facts;   ///< of the run; a resumed run must have the same
  std::uint64_t number = 0;  ///< part of the pieces' names, so that they replace none of another checkpoint
  std::uint64_t rounds = 0;  ///< rounds carried out so far, in all runs
  std::vector<CheckpointPiece> pieces;  ///< by rank
  bool operator==(const CheckpointText&) const = default;
};

/// Returns the whole file.
std::string file_of(const CheckpointText& text);
/// Reads the whole file. Throws InputError that begins with `path`.
CheckpointText read_checkpoint_text(const std::string& path, std::string_view file);

/// Writes the piece; the file appears whole or not at all.
CheckpointPiece write_checkpoint_piece(const std::string& path, const std::vector<LearntVertex>& vertices);
/// Throws InputError that begins with `path` unless the file is the piece.
std::vector<LearntVertex> read_checkpoint_piece(const std::string& path, const CheckpointPiece& piece);

/// Returns the bytes of a file. Throws InputError that begins with its path.
std::string bytes_of_file(const std::string& path);

}  // namespace podm
