// Vertex locks: the protocol, why it is safe, and the reason for each memory order. mesh.h does the same for
// reads without locks.
//
// An operation try-locks every vertex of every cell that it will replace. It takes these locks before it
// writes anything, and holds them to its end. (The inserted vertex stays unlocked: every cell with it has
// three other vertices, all locked.) The locks also protect the cells around the region, although their far
// vertices are not locked: a cell has four vertices, so two workers that each held three of them would share
// one, which is impossible. Therefore a worker that holds three vertices of a cell may read it and write its
// mirrors, and no other worker can replace it meanwhile.
// Two regions that are locked at the same time have no facet in common. Each facet of the result therefore
// borders cells of only one of them or an unchanged cell, so it is locally Delaunay by that operation's own
// work. A triangulation of the box whose facets are all locally Delaunay is the Delaunay triangulation.
//
// Locks on two vertices of a cell are enough to read it and its neighbours. A worker that replaces the cell,
// or replaces a neighbour and with it a mirror of the cell, holds three of the cell's four vertices and
// therefore one of these two. So no worker does it meanwhile. A worker that did it earlier has released a
// lock that the reader took later; or it made the cell as well as the neighbour, and the reader learnt of the
// cell after that. The points of their vertices do not change either, locked or not: a vertex is removed only
// together with all cells around it. Readers write only labels, and all write the same label
// (Rules::label_of). The worker that has reserved a cell also writes bits of the cell's word (mesh.h).
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/planted_fault.h"
#include "delaunay/step_result.h"
#include "runtime/worker_id.h"

namespace podm {

/// The locks of a run with a single worker: every attempt succeeds and costs nothing.
class NoLocks {
 public:
  static constexpr bool kIsShared = false;
  explicit NoLocks(WorkerId) {}
  static constexpr StepResult try_lock(Vertex&) { return StepResult::kDone; }
  static constexpr bool holds(const Vertex&) { return true; }
  static constexpr void unlock_all() {}
  static constexpr WorkerId conflicting_worker() { return kNoWorker; }
};

/// The locks that one worker holds. A vertex's lock word is 0 when free, otherwise the holder's id + 1.
class VertexLocks {
 public:
  static constexpr bool kIsShared = true;
  explicit VertexLocks(WorkerId self) : mine_(self + 1) {}

  /// kDone: the vertex is held, perhaps since an earlier call. kLockConflict: conflicting_worker() holds it.
  StepResult try_lock(Vertex& v) {
    const std::atomic_ref<std::uint32_t> lock(v.lock);
    step();
    // Relaxed: only this worker writes its own id, so reading it requires no other worker's writes.
    std::uint32_t holder = lock.load(std::memory_order_relaxed);
    if (holder == mine_) return StepResult::kDone;
    if (held_.size() == held_.capacity()) held_.reserve(2 * held_.size() + 64);  // may throw, therefore first
    step();
    // Acquire: sees the writes of the last holder. Relaxed on failure: only the id is used.
    if (holder == 0 &&
        lock.compare_exchange_strong(holder, mine_, order_of(OrderedAccess::kLock, std::memory_order_acquire),
                                     std::memory_order_relaxed)) {
      held_.push_back(&v);
      return StepResult::kDone;
    }
    conflicting_worker_ = holder - 1;
    return StepResult::kLockConflict;
  }
  /// Relaxed: only this worker writes its own id.
  bool holds(const Vertex& v) const { return load(v.lock, std::memory_order_relaxed) == mine_; }
  void unlock_all() {
    // Release: the next holder sees this worker's writes.
    for (Vertex* v : held_) {
      step();
      std::atomic_ref<std::uint32_t>(v->lock).store(
          0, order_of(OrderedAccess::kUnlock, std::memory_order_release));
    }
    held_.clear();
  }
  WorkerId conflicting_worker() const { return conflicting_worker_; }

 private:
  std::uint32_t mine_;
  WorkerId conflicting_worker_ = kNoWorker;
  std::vector<Vertex*> held_;
};

}  // namespace podm
