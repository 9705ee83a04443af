// Pools of unused ids, from which a worker makes cells and vertices in the memory of its own NUMA node.
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/id_arena.h"
#include "delaunay/mesh.h"

namespace podm {

/// Requests by a worker of what all workers share.
struct SharedRequests {
  std::uint64_t locks = 0;      ///< of an arena's mutex, for blocks of ids
  std::uint64_t new_bytes = 0;  ///< memory that no worker has touched before

  SharedRequests operator+(const SharedRequests& b) const {
    return {locks + b.locks, new_bytes + b.new_bytes};
  }
};

/// Unused ids of one kind: first the ids that the worker released (warm in its cache), then blocks from the
/// arena. Ids of other nodes return home through the arena, so a node's cells stay in its own memory.
class FreeIds {
 public:
  /// `num_workers` share the arena. The block size limits the ids taken at once: other workers must not lack
  /// ids long before the capacity is used up.
  FreeIds(IdArena& arena, NodeIndex node, std::size_t num_workers)
      : arena_(arena), node_(node), block_(arena.block_for(num_workers)) {}
  NodeIndex node() const { return node_; }
  bool is_own(std::uint32_t id) const { return arena_.node_of(id) == node_; }
  /// Makes room for `wanted` calls of take() and `released` calls of release(), which then allocate nothing.
  /// Throws std::bad_alloc.
  void reserve(std::size_t wanted, std::size_t released);
  std::uint32_t take();
  void release(std::uint32_t id) { (is_own(id) ? free_ : foreign_).push_back(id); }
  /// The requests so far, for ids of items of this size.
  SharedRequests requests(std::size_t item_bytes) const { return {num_locks_, num_new_ * item_bytes}; }

 private:
  IdArena& arena_;
  NodeIndex node_;
  std::uint32_t block_;  // ids taken at once
  std::vector<std::uint32_t> free_, foreign_;
  std::uint32_t next_ = 0, end_ = 0;           // the rest of the current block
  std::uint64_t num_locks_ = 0, num_new_ = 0;  // requests to the arena, and ids in its blocks
};

/// One worker's cells and vertices.
class Pool {
 public:
  /// Makes one of the pools of `num_workers` workers.
  explicit Pool(Mesh& mesh, NodeIndex node = 0, std::size_t num_workers = 1)
      : mesh_(mesh),
        cells_(mesh.cell_ids(), node, num_workers),
        vertices_(mesh.vertex_ids(), node, num_workers) {}
  NodeIndex node() const { return cells_.node(); }
  /// Makes room for an operation that replaces `dying` by `created` cells, adds a vertex and removes
  /// `removed`. The operation then allocates nothing. Throws std::bad_alloc.
  void reserve(const std::vector<CellId>& dying, std::size_t created, std::size_t removed);
  /// Provides ids for `count` cells that replace the dying ones. Reuses dying ids of its own node first: they
  /// are warm and near.
  void replace(const std::vector<CellId>& dying, std::size_t count, std::vector<CellId>& created);
  /// Makes room to take, and to release, the given numbers of cells and vertices.
  void reserve_moves(std::size_t cells, std::size_t vertices) {
    cells_.reserve(cells, cells);
    vertices_.reserve(vertices, vertices);
  }
  CellId take_cell() { return cells_.take(); }
  void release_cell(CellId c) { cells_.release(c); }
  VertexId take_vertex() { return vertices_.take(); }
  void release_vertex(VertexId v);
  SharedRequests requests() const {
    return cells_.requests(sizeof(Cell)) + vertices_.requests(sizeof(Vertex));
  }

 private:
  Mesh& mesh_;
  FreeIds cells_, vertices_;
};

}  // namespace podm
