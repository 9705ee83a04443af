#include "delaunay/relocation.h"

#include <algorithm>

namespace podm {

Relocation::Relocation(Mesh& mesh, const std::vector<NodeIndex>& nodes)
    : mesh_(mesh),
      movers_(static_cast<std::size_t>(mesh.num_nodes())),
      found_(nodes.size(), std::vector<Found>(movers_.size())),
      cells_now_(mesh.cell_bound()),
      vertices_now_(mesh.vertex_bound()) {
  for (WorkerId worker = 0; worker < nodes.size(); ++worker) movers_[nodes[worker]].push_back(worker);
  for (std::vector<WorkerId>& movers : movers_)
    if (movers.empty()) movers.push_back(0);  // items there stay, but the items that they refer to may move
}

// Calls visit(found, node) for the items that the worker moves.
template <class Visit>
void Relocation::for_each_found(WorkerId mover, const Visit& visit) const {
  for (std::size_t node = 0; node < movers_.size(); ++node) {
    const std::vector<WorkerId>& movers = movers_[node];
    const auto place = std::find(movers.begin(), movers.end(), mover);
    if (place == movers.end()) continue;
    for (auto looker = static_cast<std::size_t>(place - movers.begin()); looker < found_.size();
         looker += movers.size())
      visit(found_[looker][node], node);
  }
}

void Relocation::rename(WorkerId self, Pool& pool) {
  Ids cells, vertices;
  for_each_found(self, [&](const Found& found, std::size_t node) {
    std::copy_if(found.cells.begin(), found.cells.end(), std::back_inserter(cells),
                 [&](CellId c) { return mesh_.node_of_cell(c) != node; });
    std::copy_if(found.vertices.begin(), found.vertices.end(), std::back_inserter(vertices),
                 [&](VertexId v) { return mesh_.node_of_vertex(v) != node; });
  });
  pool.reserve_moves(cells.size(), vertices.size());
  for (const CellId c : cells) cells_now_[c] = pool.take_cell();
  for (const VertexId v : vertices) vertices_now_[v] = pool.take_vertex();
}

std::size_t Relocation::move(WorkerId self, Pool& pool) {
  std::size_t num_cells = 0;
  for_each_found(self, [&](const Found& found, std::size_t) {
    num_cells += found.cells.size();
    for (const CellId c : found.cells) {
      move_cell(c);
      if (cells_now_[c] != c) pool.release_cell(c);
    }
    for (const VertexId v : found.vertices) {
      if (vertices_now_[v] == v) continue;
      const Vertex& old = mesh_.vertex(v);
      place(mesh_.vertex(vertices_now_[v]), old.point, old.kind, old.sides);
      pool.release_vertex(v);
    }
  });
  return num_cells;
}

void Relocation::move_cell(CellId c) {
  const Cell& cell = mesh_.cell(c);
  std::array<VertexId, 4> vertices;
  std::array<FacetId, 4> mirrors;
  for (unsigned i = 0; i < 4; ++i) {
    vertices[i] = vertices_now_[cell.vertices[i]];
    mirrors[i] = facet_now(cell.mirrors[i]);
  }
  mesh_.move_cell(c, cells_now_[c], vertices, mirrors);
}

}  // namespace podm
