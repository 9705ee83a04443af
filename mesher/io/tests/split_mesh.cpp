#include "io/tests/split_mesh.h"

#include <algorithm>
#include <map>

namespace podm {
namespace {

using Facet = std::array<std::uint32_t, 3>;

constexpr std::uint32_t kUnused = ~0u;
constexpr std::uint64_t kNoId = ~0ull;

Facet sorted(Facet facet) {
  std::sort(facet.begin(), facet.end());
  return facet;
}

// Returns the cell behind each facet of the mesh: the cell of the greater label if there are two cells.
std::map<Facet, std::size_t> cells_of_facets(const TetMesh& mesh) {
  std::map<Facet, std::size_t> cell_of;
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const auto& cell = mesh.cells[c];
    for (int left_out = 0; left_out < 4; ++left_out) {
      Facet facet;
      for (int i = 0, k = 0; i < 4; ++i)
        if (i != left_out) facet[k++] = cell[i];
      const auto [entry, is_new] = cell_of.try_emplace(sorted(facet), c);
      if (!is_new && mesh.cell_labels[c] > mesh.cell_labels[entry->second]) entry->second = c;
    }
  }
  return cell_of;
}

// Renumbers vertices of the whole mesh for a piece, in the order in which they are requested.
class PieceVertices {
 public:
  PieceVertices(const TetMesh& whole, MeshPiece& piece)
      : whole_(whole), piece_(piece), position_(whole.vertices.size(), kUnused) {}

  template <std::size_t N>
  std::array<std::uint32_t, N> of_piece(std::array<std::uint32_t, N> vertices) {
    for (std::uint32_t& vertex : vertices) {
      if (position_[vertex] == kUnused) {
        position_[vertex] = static_cast<std::uint32_t>(whole_vertices.size());
        whole_vertices.push_back(vertex);
        piece_.mesh.vertices.push_back(whole_.vertices[vertex]);
      }
      vertex = position_[vertex];
    }
    return vertices;
  }
  std::vector<std::uint32_t> whole_vertices;

 private:
  const TetMesh& whole_;
  MeshPiece& piece_;
  std::vector<std::uint32_t> position_;
};

// Numbers the vertices of the piece that no earlier piece uses.
void number_vertices(const std::vector<std::uint32_t>& whole_vertices, std::vector<std::uint64_t>& id_of,
                     std::uint64_t& next_id, MeshPiece& piece) {
  for (const std::uint32_t vertex : whole_vertices) {
    piece.owns_vertex.push_back(id_of[vertex] == kNoId);
    if (id_of[vertex] == kNoId) id_of[vertex] = next_id++;
    piece.vertex_ids.push_back(id_of[vertex]);
  }
}

}  // namespace

std::vector<MeshPiece> split_into_pieces(const TetMesh& mesh, int num_pieces) {
  const auto cell_of = cells_of_facets(mesh);
  const auto first_cell = [&](int rank) {
    return mesh.cells.size() * static_cast<std::size_t>(rank) / static_cast<std::size_t>(num_pieces);
  };
  std::vector<std::uint64_t> id_of(mesh.vertices.size(), kNoId);
  std::uint64_t next_id = 0, next_facet = 0;
  std::vector<MeshPiece> pieces;
  for (int rank = 0; rank < num_pieces; ++rank) {
    MeshPiece piece;
    piece.rank = rank;
    piece.num_pieces = num_pieces;
    piece.first_cell = first_cell(rank);
    piece.first_facet = next_facet;
    piece.mesh.labels = mesh.labels;
    piece.mesh.space = mesh.space;
    PieceVertices vertices(mesh, piece);
    for (std::size_t c = first_cell(rank); c < first_cell(rank + 1); ++c) {
      piece.mesh.cells.push_back(vertices.of_piece(mesh.cells[c]));
      piece.mesh.cell_labels.push_back(mesh.cell_labels[c]);
    }
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      const std::size_t cell = cell_of.at(sorted(mesh.facets[f]));
      if (cell < first_cell(rank) || cell >= first_cell(rank + 1)) continue;
      piece.mesh.facets.push_back(vertices.of_piece(mesh.facets[f]));
      piece.mesh.facet_labels.push_back(mesh.facet_labels[f]);
    }
    next_facet += piece.mesh.facets.size();
    number_vertices(vertices.whole_vertices, id_of, next_id, piece);
    pieces.push_back(std::move(piece));
  }
  for (MeshPiece& piece : pieces) {
    piece.total_vertices = next_id;
    piece.total_cells = mesh.cells.size();
    piece.total_facets = next_facet;
  }
  return pieces;
}

}  // namespace podm
