// Unstructured grids in the layout of VTK's formats, XML and legacy: cells as types and lists of point ids.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh.h"
#include "readers/mesh_file.h"
#include "readers/number_array.h"

namespace podm::verify {

enum class CellLayout {
  kEnds,         ///< VTU: offsets hold the end of each cell in connectivity
  kStarts,       ///< legacy 5.1: one more offset, the first is 0
  kInterleaved,  ///< older legacy: connectivity holds each cell's number of points, then its points
};

struct VtkPiece {
  std::string place;   ///< for messages: "line 4, Piece"
  NumberArray points;  ///< 3 per point
  NumberArray types, offsets, connectivity;
  CellLayout layout = CellLayout::kEnds;
  std::vector<NamedArray> cell_data;  ///< of is_kept_cell_array()
};

/// Appends pieces of one file to a mesh.
class VtkAssembler {
 public:
  VtkAssembler(const MeshFile& file, Mesh& mesh) : file_(file), mesh_(mesh) {}

  /// Keeps ids beyond the piece's points if `is_only`; otherwise they would name points of other pieces.
  void append(const VtkPiece& piece, bool is_only);

 private:
  void append_points(const VtkPiece& piece);
  void append_cells(const VtkPiece& piece);
  /// The range of the ids of cell `cell` in connectivity, given that those of the cell before end at `end`.
  struct Range {
    std::size_t begin, end;
  };
  Range ids_of(const VtkPiece& piece, std::size_t cell, std::size_t end) const;
  template <std::size_t N>
  std::array<VertexId, N> corners(const VtkPiece& piece, std::size_t cell, const Range& ids,
                                  std::size_t num_ids) const;
  void append_cell_labels(const VtkPiece& piece);
  void append_facet_labels(const VtkPiece& piece);
  void append_facet_sides(const VtkPiece& piece);
  [[noreturn]] void refuse(const VtkPiece& piece, const std::string& fault) const;

  const MeshFile& file_;
  Mesh& mesh_;
  VertexId base_ = 0;                        // first id of the piece's points in the mesh
  std::uint64_t id_limit_ = 0;               // ids of the piece from this one on name no vertex
  std::vector<std::size_t> cells_, facets_;  // positions of the piece's tetrahedra and triangles; empty: all
};

}  // namespace podm::verify
