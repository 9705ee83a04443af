// Planted faults in the lock protocol and in its memory orders, for tests and CI. They show that schedules
// and the thread sanitizer (step.h) and the assertions of lock_contract.h would detect a broken protocol. An
// ordinary build has none.
#pragma once

#include <atomic>
#include <cstddef>
#include <limits>

namespace podm {

/// The numbers of vertices that an operation locks or checks. It locks `to_read` vertices of a cell before it
/// reads the cell, and `to_replace` before it replaces the cell. With to_replace = 3, it does not lock the
/// vertex beyond the facet through which it reaches a cell. It checks `in_zone` vertices to decide whether a
/// cell that it replaces is in the rank's zone. It locks `to_move` vertices of a cell that a move replaces
/// beyond the ball of its vertex, and `in_cavity` of a cell in the cavity of an optimisation. It holds
/// `to_look_up` vertices of a cell before it looks up their edges on lines. Its commit is ordered after those
/// of others by the first `to_order` vertices of its cells, which are all unless planted.
struct LocksTaken {
  unsigned to_read = 2, to_replace = 4, in_zone = 4, to_move = 4, in_cavity = 4, to_look_up = 4;
  std::size_t to_order = std::numeric_limits<std::size_t>::max();
};

/// The atomic accesses by which one worker sees what another has written. All other atomic accesses are
/// relaxed because they pass no data, or have the default order.
enum class OrderedAccess {
  kNone,
  kLock,       // VertexLocks::try_lock
  kUnlock,     // VertexLocks::unlock_all
  kPeekPoint,  // peek_point
  kPlace,      // place
  kPeekCell,   // Mesh::peek_two_vertices
  kRenew,      // Mesh::renew
};

#if defined(PODM_INTERLEAVING) || defined(PODM_CHECK_LOCKS)
/// Returns the planted numbers, or those that $PODM_PLANTED_FAULT selects: no_lock or one_lock to read a
/// cell, three_locks, three_in_zone, three_to_move or three_in_cavity to replace it, two_to_look_up edges on
/// lines, not_ordered to number its commit. Throws InputError if the variable names another fault.
LocksTaken locks_taken();
void plant_fault(LocksTaken locks);
/// Returns `order`, or the relaxed order for the access that $PODM_PLANTED_FAULT selects: relaxed_lock,
/// relaxed_unlock, relaxed_peek_point, relaxed_place, relaxed_peek_cell or relaxed_renew.
std::memory_order order_of(OrderedAccess access, std::memory_order order);
#else
constexpr LocksTaken locks_taken() { return {}; }
constexpr std::memory_order order_of(OrderedAccess, std::memory_order order) { return order; }
#endif

}  // namespace podm
