// A mesh in pieces: VTU files of cells, where each piece holds the vertices that it uses, and an index that
// names the files.
//
// The pieces are read one after the other into the arrays of the whole mesh. GlobalNodeIds identify the
// points that are one vertex. The reader checks that such points are the same to the bit, and that no number
// is left out. It does not check that the pieces fit together: conformity is a claim about the whole mesh.
#include <fmt/format.h>

#include "errors.h"
#include "readers/formats.h"
#include "readers/mesh_parts.h"
#include "readers/pvtu_pieces.h"
#include "readers/vtu_document.h"
#include "readers/vtu_grid.h"

namespace podm::verify {
namespace {

class PieceMerger {
 public:
  // `num_points`, summed over all pieces, is at least the number of vertices.
  PieceMerger(const MeshFile& index, const std::vector<PieceSource>& pieces, std::uint64_t num_points)
      : index_(index), pieces_(pieces), vertices_(num_points), piece_of_(num_points, kNone) {}

  void add(const MeshFile& file) {
    const VtuGrid grid = read_vtu_grid(file, kGlobalIds);
    if (num_added_ == 0) {
      take_head(grid.mesh, whole_);
      whole_.format = format_of_pieces(pieces_.size(), grid.mesh.format);
    }
    check_labels_and_space(file, grid.mesh, whole_);
    for (std::size_t i = 0; i < grid.point_ids.size(); ++i) add_point(file, grid, i);
    const std::vector<VertexId> vertex_of = vertex_ids(grid);
    append_cells(file, grid, vertex_of, whole_);
    append_facets(file, grid, vertex_of, whole_);
    for (const auto& [kind, count] : grid.mesh.other_cells) whole_.other_cells[kind] += count;
    ++num_added_;
  }

  Mesh finish() {
    for (std::size_t id = 0; id < num_vertices_; ++id) {
      if (piece_of_[id] == kNone) {
        index_.refuse(kGlobalIds, fmt::format("no piece has vertex {}, and they number vertices up to {}", id,
                                              num_vertices_ - 1));
      }
    }
    vertices_.resize(num_vertices_);
    whole_.vertices = std::move(vertices_);
    return std::move(whole_);
  }

 private:
  void add_point(const MeshFile& file, const VtuGrid& grid, std::size_t i) {
    const GlobalId id = grid.point_ids[i];
    const auto refuse = [&](const std::string& fault) {
      file.refuse(grid.ids_place, fmt::format("point {}: {}", i, fault));
    };
    if (id >= vertices_.size()) {
      refuse(fmt::format("its number is not below {}, of points in all pieces: numbers from 0 are left out",
                         vertices_.size()));
    }
    const Point& point = grid.mesh.vertices[i];
    std::uint32_t& piece = piece_of_[id];
    if (piece == kNone) {
      vertices_[id] = point;
      num_vertices_ = std::max<std::size_t>(num_vertices_, id + std::size_t{1});
    } else if (piece == num_added_) {
      refuse(fmt::format("vertex {} is twice in this piece", id));
    } else if (!is_same_point(vertices_[id], point)) {
      refuse(fmt::format("vertex {} is at {}, in {} at {}", id, text_of(point), pieces_[piece].path,
                         text_of(vertices_[id])));
    }
    piece = num_added_;
  }

  const MeshFile& index_;
  const std::vector<PieceSource>& pieces_;
  Mesh whole_;
  std::vector<Point> vertices_;          // by number; its size is the number of points in all pieces
  std::vector<std::uint32_t> piece_of_;  // by number: the last piece that has it; kNone: none yet
  std::size_t num_vertices_ = 0;
  std::uint32_t num_added_ = 0;
};

}  // namespace

Mesh read_pvtu(const MeshFile& index) {
  const std::vector<PieceSource> pieces = parse_pvtu(index);
  std::uint64_t num_points = 0;
  for_each_piece(index, pieces, [&](const MeshFile& file) {
    num_points += count_vtu_points(file);
    check_counts(file, "Points", num_points, 0);
  });
  PieceMerger merger(index, pieces, num_points);
  for_each_piece(index, pieces, [&](const MeshFile& file) { merger.add(file); });
  return merger.finish();
}

void read_pvtu_facets(const MeshFile& index, Mesh& mesh) {
  for_each_piece(index, parse_pvtu(index), [&](const MeshFile& file) {
    const VtuGrid grid = read_vtu_grid(file, kGlobalIds);
    check_labels_and_space(file, grid.mesh, mesh);
    check_points(file, grid, mesh);
    append_facets(file, grid, vertex_ids(grid), mesh);
  });
}

}  // namespace podm::verify
