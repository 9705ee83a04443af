// The contract of vertex_locks.h, asserted at every access to a cell in a build with PODM_CHECK_LOCKS. In any
// other build the assertions do nothing.
//
//   A worker reads a cell under locks on two of its vertices, or on two of a neighbour's. It writes the
//   cell's mirrors and sphere under three locks, and replaces the cell under all four. Vertices that no other
//   worker can reach may count as held (algorithms/leaf_locks.h). Where operations read beyond a zone but
//   change nothing there, only the zone's vertices count as held for a change (distributed/zone.h).
//
// Vertices are not checked. A worker that may read a cell may read its vertices. Before a vertex is locked,
// its point is only peeked at. Only the maker of a vertex, or the owner of its cavity, writes to it. The
// contract binds attempts. Code that uses the store outside of an attempt has it alone: before workers run,
// after they have ended, and where the master of a computing node ends a leaf; or all threads read it and
// none writes, where cells are distributed to leaves. The contract does not bind peeks and prefetches.
#pragma once

#include <cstdint>

namespace podm {

class Mesh;
struct Vertex;

#ifdef PODM_CHECK_LOCKS
/// An attempt of this thread, or of this fibre, under these locks. It lasts until the scope ends.
class AttemptScope {
 public:
  template <class Locks>
  explicit AttemptScope(const Locks& locks)
      : locks_(&locks), holds_(&holds_by<Locks>), may_change_(&may_change_by<Locks>) {
    begin();
  }
  ~AttemptScope();
  AttemptScope(const AttemptScope&) = delete;
  AttemptScope& operator=(const AttemptScope&) = delete;
  bool holds(const Vertex& v) const { return holds_(locks_, v); }
  /// True if v counts as held for a change: the locks' own may_change(v) if they have one, otherwise
  /// holds(v).
  bool may_change(const Vertex& v) const { return may_change_(locks_, v); }

 private:
  using Predicate = bool(const void* locks, const Vertex& v);

  void begin();
  template <class Locks>
  static bool holds_by(const void* locks, const Vertex& v) {
    return static_cast<const Locks*>(locks)->holds(v);
  }
  template <class Locks>
  static bool may_change_by(const void* locks, const Vertex& v) {
    if constexpr (requires(const Locks& l) { l.may_change(v); }) {
      return static_cast<const Locks*>(locks)->may_change(v);
    } else {
      return holds_by<Locks>(locks, v);
    }
  }

  const void* locks_;
  Predicate* holds_;
  Predicate* may_change_;
};

/// Abort with a message if the current attempt may not access the cell in this way.
void assert_may_read(const Mesh& mesh, std::uint32_t cell);
void assert_may_write_mirrors(const Mesh& mesh, std::uint32_t cell);
/// Passes for a slot without a living cell, which belongs to its pool.
void assert_may_replace(const Mesh& mesh, std::uint32_t cell);
#else
class AttemptScope {
 public:
  template <class Locks>
  explicit AttemptScope(const Locks&) {}
};
inline void assert_may_read(const Mesh&, std::uint32_t) {}
inline void assert_may_write_mirrors(const Mesh&, std::uint32_t) {}
inline void assert_may_replace(const Mesh&, std::uint32_t) {}
#endif

}  // namespace podm
