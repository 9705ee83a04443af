// What a worker makes cells and vertices of: ids that nobody uses, in memory of the NUMA node it runs on.
#pragma once

#include <vector>

#include "delaunay/id_arena.h"
#include "delaunay/mesh.h"

namespace podm {

/// Unused ids of one kind: those that the worker set free (warm in its cache), then blocks from the arena.
/// Ids of other nodes go home through the arena, so that a node's cells stay in its own memory.
class FreeIds {
 public:
  /// `num_workers` share the arena: none takes so many ids at once that others could lack them long before
  /// the end.
  FreeIds(IdArena& arena, NodeIndex node, std::size_t num_workers)
      : arena_(arena), node_(node), block_(arena.block_for(num_workers)) {}
  NodeIndex node() const { return node_; }
  bool is_own(std::uint32_t id) const { return arena_.node_of(id) == node_; }
  /// Makes room: `wanted` take() and `released` release() then allocate nothing. Throws std::bad_alloc.
  void reserve(std::size_t wanted, std::size_t released);
  std::uint32_t take();
  void release(std::uint32_t id) { (is_own(id) ? free_ : foreign_).push_back(id); }

 private:
  IdArena& arena_;
  NodeIndex node_;
  std::uint32_t block_;  // ids taken at once
  std::vector<std::uint32_t> free_, foreign_;
  std::uint32_t next_ = 0, end_ = 0;  // what is left of the block at hand
};

/// One worker's cells and vertices.
class Pool {
 public:
  /// It is one of the pools of `num_workers` workers.
  explicit Pool(Mesh& mesh, NodeIndex node = 0, std::size_t num_workers = 1)
      : mesh_(mesh),
        cells_(mesh.cell_ids(), node, num_workers),
        vertices_(mesh.vertex_ids(), node, num_workers) {}
  NodeIndex node() const { return cells_.node(); }
  /// Makes room: an operation that replaces `dying` by `created` cells, adds a vertex and removes `removed`
  /// then allocates nothing. Throws std::bad_alloc.
  void reserve(const std::vector<CellId>& dying, std::size_t created, std::size_t removed);
  /// Ids for `count` cells in place of the dying. Those among them that are warm, and near, come first.
  void replace(const std::vector<CellId>& dying, std::size_t count, std::vector<CellId>& created);
  /// Makes room to take so many cells and vertices, and to release as many.
  void reserve_moves(std::size_t cells, std::size_t vertices) {
    cells_.reserve(cells, cells);
    vertices_.reserve(vertices, vertices);
  }
  CellId take_cell() { return cells_.take(); }
  void release_cell(CellId c) { cells_.release(c); }
  VertexId take_vertex() { return vertices_.take(); }
  void release_vertex(VertexId v);

 private:
  Mesh& mesh_;
  FreeIds cells_, vertices_;
};

}  // namespace podm
