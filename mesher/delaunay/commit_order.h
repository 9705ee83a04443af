// The order of the commits of workers that share a mesh: their sequence numbers in the linearization log.
//
// Every vertex has a stamp, and every worker has one, too. An operation commits with the least number that is
// above the stamps of its worker and of all vertices of the cells that it replaces and makes, and that no
// other worker uses: worker w of n takes numbers w, w + n, w + 2 n, ... The number becomes the stamp of this
// worker and of these vertices. (Lamport, "Time, clocks, and the ordering of events in a distributed system",
// 1978.) A counter that all workers increment would also do. However, its cache line would pass from worker
// to worker at every commit, and it passes 5 to 20 million times per second at most. Blocks of numbers of
// such a counter do not give an order: a worker would use the numbers of an old block after another worker,
// on the same vertices, has used those of a newer one. Clocks of processors may differ.
//
// Proposition 1. If two operations have a vertex in common, the later one has the greater number. Proof: A
// vertex of a replaced cell is locked, or no other worker can reach it (leaf_locks.h), until the stamp is
// written. The next worker that may use the vertex sees the stamp, as it sees the cells around it. The
// inserted vertex is not locked. However, an operation with this vertex replaces a cell around it that the
// insertion or a later operation has made. It holds the other three vertices of that cell, which the maker
// has unlocked after it wrote the stamp. An id that is used again passes through a pool of the same worker,
// or through the mutex of the arena (id_arena.h). Therefore an insertion also follows the removal of the last
// vertex of its id.
//
// Proposition 2. The operations in the order of their numbers, one after another, make the same cells as the
// workers did. Proof: Two operations without a common vertex have no cell and no facet in common: a cell
// beyond a boundary facet has three vertices of the region. They replace different cells, and neither writes
// what the other reads, so they may be exchanged. The order in time becomes the order of numbers by exchanges
// of neighbours, and by Proposition 1 each of them has no common vertex. Real time does not matter.
//
// Every vertex of a replaced cell is removed or is a vertex of a new cell. The operation therefore finds all
// vertices in what the commit has made and removed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "podm/operation_log.h"
#include "runtime/huge_array.h"
#include "runtime/worker_id.h"

namespace podm {

class CommitOrder {
 public:
  /// Orders the commits of workers 0 to num_workers - 1. All of them must be made with this object.
  CommitOrder(const Mesh& mesh, OperationLogWriter& log, std::size_t num_workers)
      : mesh_(mesh), log_(log), stamps_(mesh.vertex_capacity()), of_worker_(num_workers) {}

  OperationLogWriter& log() const { return log_; }
  /// Returns the number of the worker's operation that has just made and removed these, and still holds its
  /// locks.
  std::uint64_t next(WorkerId self, const std::vector<CellId>& created,
                     const std::vector<VertexId>& removed) {
    std::uint64_t least = std::max(of_worker_[self].least, log_.least_sequence());
    for_each_stamp(created, removed, [&](std::uint64_t stamp) { least = std::max(least, stamp); });
    const std::uint64_t count = of_worker_.size();
    const std::uint64_t number = least + (self + count - least % count) % count;
    for_each_stamp(created, removed, [&](std::uint64_t& stamp) { stamp = number + 1; });
    of_worker_[self].least = number + 1;
    return number;
  }
  /// Returns the first of `count` consecutive numbers, for entries that are made between operations. Later
  /// operations get greater numbers.
  std::uint64_t next_between_operations(std::uint64_t count) {
    std::uint64_t first = log_.least_sequence();
    for (const OfWorker& worker : of_worker_) first = std::max(first, worker.least);
    log_.set_least_sequence(first + count);
    return first;
  }

 private:
  /// In a line of its own, which no other worker uses.
  struct alignas(128) OfWorker {
    std::uint64_t least = 0;  // for its next commit
  };

  template <class Visit>
  void for_each_stamp(const std::vector<CellId>& created, const std::vector<VertexId>& removed,
                      const Visit& visit) {
    std::size_t left = locks_taken().to_order;
    const auto visit_if_ordered = [&](VertexId v) {
      step();
      if (left > 0) visit(stamps_[v]), --left;
    };
    for (const VertexId v : removed) visit_if_ordered(v);
    for (const CellId c : created)
      for (const VertexId v : mesh_.cell(c).vertices) visit_if_ordered(v);
  }

  const Mesh& mesh_;
  OperationLogWriter& log_;
  HugeArray<std::uint64_t> stamps_;  // by vertex: the least number of its next operation
  std::vector<OfWorker> of_worker_;
};

}  // namespace podm
