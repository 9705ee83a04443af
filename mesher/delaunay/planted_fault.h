// Planted faults in the lock protocol for tests and CI. They show that schedules and the thread sanitizer
// (step.h) and the assertions of lock_contract.h would detect a broken protocol. An ordinary build has none.
#pragma once

namespace podm {

/// The numbers of vertices that an operation locks or checks. It locks `to_read` vertices of a cell before it
/// reads the cell, and `to_replace` before it replaces the cell. With to_replace = 3, it does not lock the
/// vertex beyond the facet through which it reaches a cell. It checks `in_zone` vertices to decide whether a
/// cell that it replaces is in the rank's zone. It locks `to_move` vertices of a cell that a move replaces
/// beyond the ball of its vertex, and `in_cavity` of a cell in the cavity of an optimisation.
struct LocksTaken {
  unsigned to_read = 2, to_replace = 4, in_zone = 4, to_move = 4, in_cavity = 4;
};

#if defined(PODM_INTERLEAVING) || defined(PODM_CHECK_LOCKS)
/// Returns the planted numbers, or those that $PODM_PLANTED_FAULT selects: no_lock or one_lock to read a
/// cell, three_locks, three_in_zone, three_to_move or three_in_cavity to replace it. Throws InputError if the
/// variable names another fault.
LocksTaken locks_taken();
void plant_fault(LocksTaken locks);
#else
constexpr LocksTaken locks_taken() { return {}; }
#endif

}  // namespace podm
