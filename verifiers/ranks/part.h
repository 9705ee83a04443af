// A rank's part of a mesh, and the numbers of its cells and vertices in the whole mesh.
//
// Each rank has cells of its own, which follow one another in the whole mesh. It also holds the cells of
// other ranks that share a vertex with its own, so that it holds all cells around each vertex of its own
// cells. A vertex that several ranks hold belongs to the first rank whose pieces have it. Cells and vertices
// have the same order on the rank as in the whole mesh: a check that visits the rank's own cells, facets and
// vertices finds on all ranks together what it finds in the whole mesh, each once.
//
// Without ranks the functions below return the positions themselves, and all cells and vertices are own.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "mesh.h"
#include "ranks/communication.h"

namespace podm::verify {

struct IdRange {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
};

struct Part {
  Communication* ranks = nullptr;
  GlobalId num_vertices = 0;          ///< of the whole mesh
  std::vector<GlobalId> first_cells;  ///< of each rank; then the number of cells
  bool has_cell_labels = false;       ///< of the whole mesh
  IdRange own_cells;                  ///< positions in Mesh::cells
  std::vector<GlobalId> other_cells;  ///< numbers of the cells before and after these, ascending
  std::vector<GlobalId> vertices;     ///< numbers of the rank's vertices, ascending
  std::vector<std::uint8_t> is_own_vertex;
  std::vector<GlobalId> facets;   ///< numbers of Mesh::facets, ascending
  GlobalId num_facets = 0;        ///< listed by the whole mesh
  bool has_facet_labels = false;  ///< of the whole mesh
};

inline Communication& ranks_of(const Mesh& mesh) {
  static SingleRank single;
  return mesh.part ? *mesh.part->ranks : single;
}
inline bool is_first_rank(const Mesh& mesh) { return ranks_of(mesh).rank() == 0; }

inline GlobalId num_cells(const Mesh& mesh) {
  return mesh.part ? mesh.part->first_cells.back() : mesh.cells.size();
}
inline GlobalId num_vertices(const Mesh& mesh) {
  return mesh.part ? mesh.part->num_vertices : mesh.vertices.size();
}
inline GlobalId num_facets(const Mesh& mesh) {
  return mesh.part ? mesh.part->num_facets : mesh.facets.size();
}
inline bool has_facet_labels(const Mesh& mesh) {
  return mesh.part ? mesh.part->has_facet_labels : !mesh.facet_labels.empty();
}
inline bool has_cell_labels(const Mesh& mesh) {
  return mesh.part ? mesh.part->has_cell_labels
                   : !mesh.cells.empty() && mesh.cell_labels.size() == mesh.cells.size();
}

inline IdRange own_cells(const Mesh& mesh) {
  return mesh.part ? mesh.part->own_cells : IdRange{0, mesh.cells.size()};
}
/// Facets are 4 * cell + i (geometry/adjacency.h).
inline IdRange own_facets(const Mesh& mesh) {
  const IdRange cells = own_cells(mesh);
  return {4 * cells.begin, 4 * cells.end};
}
inline bool owns_cell(const Mesh& mesh, CellId c) {
  const IdRange own = own_cells(mesh);
  return c >= own.begin && c < own.end;
}
inline bool owns_vertex(const Mesh& mesh, std::size_t v) {
  return !mesh.part || mesh.part->is_own_vertex[v] != 0;
}

inline GlobalId global_cell(const Mesh& mesh, CellId c) {
  if (!mesh.part) return c;
  const IdRange& own = mesh.part->own_cells;
  const auto rank = static_cast<std::size_t>(mesh.part->ranks->rank());
  if (c >= own.begin && c < own.end) return mesh.part->first_cells[rank] + (c - own.begin);
  return mesh.part->other_cells[c < own.begin ? c : c - own.size()];
}
/// An id that names no vertex is returned as it is.
inline GlobalId global_vertex(const Mesh& mesh, VertexId v) {
  return mesh.part && v < mesh.part->vertices.size() ? mesh.part->vertices[v] : v;
}
template <class Vertices>
std::vector<GlobalId> global_vertices(const Mesh& mesh, const Vertices& vertices) {
  std::vector<GlobalId> ids;
  for (const VertexId v : vertices) ids.push_back(global_vertex(mesh, v));
  return ids;
}
inline GlobalId global_facet(const Mesh& mesh, std::size_t listed) {
  return mesh.part ? mesh.part->facets[listed] : listed;
}

/// Returns the rank whose own cell this is.
inline std::size_t owner_of_cell(const Mesh& mesh, GlobalId cell) {
  if (!mesh.part) return 0;
  const auto& first = mesh.part->first_cells;
  return static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), cell) - first.begin()) - 1;
}
/// Returns the cells in ascending order, each once.
std::vector<GlobalId> ascending(std::vector<GlobalId> cells);
/// Collective. Returns those of the cells that all ranks name which this rank owns, ascending, each once.
std::vector<GlobalId> own_of(const Mesh& mesh, std::vector<GlobalId> cells);

/// Returns one list per rank, all empty.
template <class Item>
std::vector<std::vector<Item>> lists_for(Communication& ranks) {
  return std::vector<std::vector<Item>>(static_cast<std::size_t>(ranks.size()));
}

}  // namespace podm::verify
