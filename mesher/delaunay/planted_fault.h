// Faults in the lock protocol for tests and CI to plant: they show that a broken protocol would be seen, by
// schedules and the thread sanitizer (step.h) and by the assertions of lock_contract.h. An ordinary build has
// none.
#pragma once

namespace podm {

/// How many of a cell's vertices are locked before it is read, and before it is replaced. With three to
/// replace it, the vertex beyond the facet by which an operation comes to a cell is not locked. And how many
/// an operation looks at to find out that a cell which it replaces is in the rank's zone; and how many are
/// locked of a cell that a move replaces beyond the ball of its vertex, and of one in a cavity of an
/// optimisation.
struct LocksTaken {
  unsigned to_read = 2, to_replace = 4, in_zone = 4, to_move = 4, in_cavity = 4;
};

#if defined(PODM_INTERLEAVING) || defined(PODM_CHECK_LOCKS)
/// They are as planted, or as $PODM_PLANTED_FAULT says: no_lock or one_lock to read a cell, three_locks,
/// three_in_zone, three_to_move or three_in_cavity to replace it. Throws InputError when it names another
/// fault.
LocksTaken locks_taken();
void plant_fault(LocksTaken locks);
#else
constexpr LocksTaken locks_taken() { return {}; }
#endif

}  // namespace podm
