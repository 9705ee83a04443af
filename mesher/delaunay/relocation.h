// Moves a mesh to the memory of the workers that will use it next: cells and vertices get ids of other NUMA
// nodes.
//
//   The move has three steps. All workers carry out each step, and no worker starts a step before all have
//   ended the previous one. Workers do not conflict: in the first step, each looks at its own part of the
//   ids. In the later steps, each owns the cells and vertices that it moves to its own node, and no other
//   worker touches their old or new slots. The new ids of other workers' cells and vertices, which it also
//   needs, are known before the last step.
#pragma once

#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/pool.h"
#include "runtime/worker_id.h"

namespace podm {

class Relocation {
 public:
  static constexpr NodeIndex kStay = 0xffff;

  /// Worker i of nodes.size() is on nodes[i]. No operation may run until the move is over.
  Relocation(Mesh& mesh, const std::vector<NodeIndex>& nodes);

  /// Step 1: node_of(point) is the node to which cells with that circumcenter and vertices at that point
  /// move: a worker's node or kStay. Throws std::bad_alloc.
  template <class NodeOf>
  void look(WorkerId self, const NodeOf& node_of) {
    for_part(cells_now_, self, [&](CellId c) {
      if (mesh_.cell(c).is_alive())
        found_at(node_of(mesh_.cell(c).center), mesh_.node_of_cell(c), self).cells.push_back(c);
    });
    for_part(vertices_now_, self, [&](VertexId v) {
      if (mesh_.vertex(v).kind != VertexKind::kUnused && mesh_.vertex(v).kind != VertexKind::kBox)
        found_at(node_of(mesh_.point(v)), mesh_.node_of_vertex(v), self).vertices.push_back(v);
    });
  }
  /// Step 2: takes ids from the worker's pool. Throws std::bad_alloc; then step 3 must not run.
  void rename(WorkerId self, Pool& pool);
  /// Step 3: moves the worker's cells and vertices to their new ids and returns the old ids to its pool.
  /// Returns the number of cells rewritten.
  std::size_t move(WorkerId self, Pool& pool);

  /// Returns the id after the move; it is the same if the item stayed.
  CellId cell_now(CellId c) const { return cells_now_[c]; }
  VertexId vertex_now(VertexId v) const { return vertices_now_[v]; }
  /// The number of workers that carry out each step.
  std::size_t num_workers() const { return found_.size(); }
  /// All old cell ids are below it.
  CellId cell_bound() const { return static_cast<CellId>(cells_now_.size()); }
  /// All old vertex ids are below it.
  VertexId vertex_bound() const { return static_cast<VertexId>(vertices_now_.size()); }

 private:
  using Ids = std::vector<std::uint32_t>;
  // The items found by one worker that move to one node.
  struct Found {
    Ids cells, vertices;
  };

  template <class Visit>
  void for_part(Ids& now, WorkerId self, const Visit& visit) {
    const std::size_t begin = now.size() * self / found_.size(),
                      end = now.size() * (self + 1) / found_.size();
    for (std::size_t id = begin; id < end; ++id) {
      now[id] = static_cast<std::uint32_t>(id);
      visit(now[id]);
    }
  }
  Found& found_at(NodeIndex node, NodeIndex current, WorkerId self) {
    return found_[self][node == kStay ? current : node];
  }
  template <class Visit>
  void for_each_found(WorkerId mover, const Visit& visit) const;
  FacetId facet_now(FacetId f) const { return f == kNoFacet ? f : 4 * cells_now_[cell_of(f)] + (f & 3u); }
  void move_cell(CellId c);

  Mesh& mesh_;
  std::vector<std::vector<WorkerId>> movers_;  // indexed by node
  std::vector<std::vector<Found>> found_;      // indexed by the worker that looked, and node
  Ids cells_now_, vertices_now_;               // indexed by the old id
};

}  // namespace podm
