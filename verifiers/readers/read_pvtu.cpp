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
#include "readers/pvtu_index.h"
#include "readers/vtu_document.h"
#include "readers/vtu_grid.h"

namespace podm::verify {
namespace {

// Calls read(file) for each piece. An error names the index, too.
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

std::string text_of(const Point& point) { return fmt::format("({}, {}, {})", point[0], point[1], point[2]); }

// Throws unless two pieces of one mesh name the same labels and the same space.
void check_labels_and_space(const MeshFile& file, const Mesh& piece, const Mesh& first) {
  if (piece.space != first.space) file.refuse("FieldData", "the space is not that of the first piece");
  if (piece.smoothing_mm != first.smoothing_mm)
    file.refuse("FieldData", "the width of smoothing is not that of the first piece");
  for (const auto* names : {&piece.label_names, &first.label_names}) {
    for (const auto& [value, name] : *names) {
      const auto here = piece.label_names.find(value), there = first.label_names.find(value);
      const auto name_in = [&](const auto& found, const Mesh& mesh) {
        return found == mesh.label_names.end() ? std::string("not named")
                                               : fmt::format("'{}'", found->second);
      };
      if (name_in(here, piece) == name_in(there, first)) continue;
      file.refuse("FieldData", fmt::format("label {} is {}, in the first piece {}", value,
                                           name_in(here, piece), name_in(there, first)));
    }
  }
}

class PieceMerger {
 public:
  // `num_points`, summed over all pieces, is at least the number of vertices.
  PieceMerger(const MeshFile& index, const std::vector<PieceSource>& pieces, std::uint64_t num_points)
      : index_(index), pieces_(pieces), vertices_(num_points), piece_of_(num_points, kNone) {}

  void add(const MeshFile& file) {
    const VtuGrid grid = read_vtu_grid(file, kGlobalIds);
    if (num_added_ == 0) {
      whole_.format = fmt::format("PVTU of {} pieces: {}", pieces_.size(), grid.mesh.format);
      whole_.space = grid.mesh.space;
      whole_.label_names = grid.mesh.label_names;
      whole_.label_colours = grid.mesh.label_colours;
      whole_.unclaimed = grid.mesh.unclaimed;
      whole_.promised_dihedral_deg = grid.mesh.promised_dihedral_deg;
      whole_.smoothing_mm = grid.mesh.smoothing_mm;
    }
    check_labels_and_space(file, grid.mesh, whole_);
    for (std::size_t i = 0; i < grid.point_ids.size(); ++i) add_point(file, grid, i);
    append_cells(file, grid, grid.point_ids, whole_);
    append_facets(file, grid, grid.point_ids, whole_);
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
    const VertexId id = grid.point_ids[i];
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
    append_facets(file, grid, grid.point_ids, mesh);
  });
}

}  // namespace podm::verify
