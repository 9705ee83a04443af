// A mesh in pieces as VTK's HDF files of version 1.0: "x.vtkhdf" holds the cells, "x_facets.vtkhdf" the
// facets, each with one partition per piece. VTK 9.1 and ParaView 5.10, and later versions, read them. This
// file declares the steps; distributed/write_pieces.h performs them on all ranks.
//
//   /VTKHDF/NumberOfPoints, NumberOfCells, NumberOfConnectivityIds   int64, one per piece
//   /VTKHDF/Points, Connectivity, Offsets, Types                     those of the pieces, one after the other
//   /VTKHDF/PointData/GlobalNodeIds                                  int64, numbers in the whole mesh
//   /VTKHDF/CellData/label; label_a, label_b                         uint32, values, as in .vtu files
//   /VTKHDF/FieldData/space, promises, label_value, label_name, label_colours
//
// Vertices are numbered piece by piece, so a vertex of several pieces is there several times.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "io/shared_rows.h"
#include "io/vertex_subset.h"
#include "podm/mesh_piece.h"

namespace podm {

/// The numbers of points and cells of one partition.
struct VtkhdfSize {
  std::uint64_t points = 0, cells = 0;
};

/// A piece's cells, or its facets, as a partition.
class VtkhdfPart {
 public:
  enum class Kind { kCells, kFacets };
  VtkhdfPart(const MeshPiece& piece, Kind kind);

  const TetMesh& mesh() const { return piece_.mesh; }
  VtkhdfSize size() const { return size_; }
  std::size_t corners_per_cell() const { return kind_ == Kind::kCells ? 4 : 3; }
  std::uint8_t cell_type() const;
  std::vector<std::string> names_of_labels() const;
  const std::array<double, 3>& point(std::size_t i) const { return piece_.mesh.vertices[vertex(i)]; }
  std::uint64_t id(std::size_t i) const { return piece_.vertex_ids[vertex(i)]; }
  std::uint32_t corner(std::size_t cell, std::size_t i) const;
  /// The value of the label of a cell, or on one side of a facet.
  std::uint32_t label(std::size_t cell, std::size_t side) const;

 private:
  std::size_t vertex(std::size_t i) const { return kind_ == Kind::kCells ? i : used_.vertices()[i]; }

  const MeshPiece& piece_;
  const Kind kind_;
  VertexSubset used_;  // of facets
  VtkhdfSize size_;
};

struct VtkhdfArrays {
  RowsInFile points, ids, connectivity, offsets, types;
  std::array<RowsInFile, 2> labels;
};

/// Makes the arrays of all pieces in `file`, a new one. Any part may be passed. Throws InputError that names
/// `path`.
VtkhdfArrays create_vtkhdf(const std::string& file, const std::string& path, const VtkhdfPart& part,
                           const std::vector<VtkhdfSize>& sizes);
/// Writes the partition of piece number `rank`. All pieces may be written at once.
void write_vtkhdf_part(const std::string& file, const std::string& path, const VtkhdfPart& part,
                       const std::vector<VtkhdfSize>& sizes, int rank, const VtkhdfArrays& arrays);

}  // namespace podm
