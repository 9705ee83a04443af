// The contract of vertex_locks.h, asserted at every access to a cell in a build with PODM_CHECK_LOCKS: in any
// other there is nothing to it.
//
//   A cell is read under locks on two of its vertices, or on two of a neighbour's. Its mirrors and its sphere
//   are written under three, and it is replaced under all four. Locks may count as held what no other worker
//   can reach (algorithms/leaf_locks.h). Where operations read beyond a zone but change nothing
//   there, only its vertices count as held for a change (distributed/zone.h).
//
// Vertices go unchecked: whoever may read a cell may read its vertices, those that locks are tried on are
// peeked at, and what is written of one is its maker's, or its cavity's owner's. The contract binds attempts.
// Whoever uses the store outside of one has it alone: before workers run, after they have ended, and where
// the master of a computing node ends a leaf; or all read it and none writes, where cells are distributed to
// leaves. Peeks and prefetches are bound by nothing.
#pragma once

#include <cstdint>

namespace podm {

class Mesh;
struct Vertex;

#ifdef PODM_CHECK_LOCKS
/// An attempt of this thread, or of this fibre, under these locks, until the scope ends.
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
  /// Whether v counts as held for a change: the locks' own answer, if they have one, else holds(v).
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

/// These abort, and say why, where the attempt at hand may not do so.
void assert_may_read(const Mesh& mesh, std::uint32_t cell);
void assert_may_write_mirrors(const Mesh& mesh, std::uint32_t cell);
/// A slot without a living cell is its pool's, which may do so.
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
