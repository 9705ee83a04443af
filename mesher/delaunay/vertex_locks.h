// Vertex locks: the protocol, why it is safe, and the reason for each memory order. What is read without
// locks is in mesh.h, likewise.
//
// An operation try-locks every vertex of every cell it is going to replace before it writes anything, and
// keeps them to its end. (Nobody locks the vertex that it inserts: a cell that gets it has three others, all
// locked.) That guards the cells around the region too, without their far vertices: a cell has four vertices,
// so two workers that each hold three of them share one, which cannot be. Hence whoever holds three vertices
// of a cell may read it and write its mirrors, and nobody can replace it meanwhile.
// And two regions that are locked at the same time have no facet in common: each facet of the result borders
// cells of only one of them or an unchanged cell, so it is locally Delaunay by that operation's own work, and
// a triangulation of the box whose facets all are is the Delaunay triangulation.
//
// Two vertices of a cell are enough to read it and its neighbours. Who replaces the cell, or a neighbour and
// with it a mirror, holds three of the cell's four vertices, hence one of the two. So nobody does meanwhile.
// Who did before has released a lock that the reader took later, or made the cell as well as the neighbour,
// and the reader learnt of the cell after that. The points of their vertices stay, too, locked or not: a
// vertex goes with all cells around it. Only labels are written by readers, all the same (Rules::label_of).
#pragma once

#include <cstdint>
#include <vector>

#include "delaunay/mesh.h"
#include "delaunay/step_result.h"
#include "runtime/worker_id.h"

namespace podm {

/// The locks of a run that nobody shares: every attempt succeeds and costs nothing.
class NoLocks {
 public:
  static constexpr bool kIsShared = false;
  explicit NoLocks(WorkerId) {}
  static constexpr StepResult try_lock(Vertex&) { return StepResult::kDone; }
  static constexpr bool holds(const Vertex&) { return true; }
  static constexpr void unlock_all() {}
  static constexpr WorkerId conflicting_worker() { return kNoWorker; }
};

/// What one worker holds. A vertex's lock word is 0 when free, else the holder's id + 1.
class VertexLocks {
 public:
  static constexpr bool kIsShared = true;
  explicit VertexLocks(WorkerId self) : mine_(self + 1) {}

  /// kDone: the vertex is held, maybe from before. kLockConflict: conflicting_worker() holds it.
  StepResult try_lock(Vertex& v) {
    const std::atomic_ref<std::uint32_t> lock(v.lock);
    step();
    // Relaxed: only we write our own id, so seeing it needs nobody else's writes.
    std::uint32_t holder = lock.load(std::memory_order_relaxed);
    if (holder == mine_) return StepResult::kDone;
    if (held_.size() == held_.capacity()) held_.reserve(2 * held_.size() + 64);  // may throw, so first
    step();
    // Acquire: sees what the last holder wrote. Relaxed on failure: nothing but the id is used.
    if (holder == 0 &&
        lock.compare_exchange_strong(holder, mine_, std::memory_order_acquire, std::memory_order_relaxed)) {
      held_.push_back(&v);
      return StepResult::kDone;
    }
    conflicting_worker_ = holder - 1;
    return StepResult::kLockConflict;
  }
  /// Relaxed: only we write our own id.
  bool holds(const Vertex& v) const { return load(v.lock, std::memory_order_relaxed) == mine_; }
  void unlock_all() {
    // Release: the next holder sees what we wrote.
    for (Vertex* v : held_) {
      step();
      std::atomic_ref<std::uint32_t>(v->lock).store(0, std::memory_order_release);
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
