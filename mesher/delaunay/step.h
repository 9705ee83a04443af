// The places where a worker reads or writes what others share. In an ordinary build there is nothing to them.
//
// With PODM_INTERLEAVING another worker may go on at each of them, as it would with a core to each worker: a
// thread yields now and then, and an attempt of the virtual executor stops there and goes on later. What that
// attempt has read must be as it was until it is over: replacing a cell that another has read is an error.
// Such a build can also plant a fault in the lock protocol, by which tests and ci/race.sh show that they
// would see one: a cell is read under fewer locks than the two of vertex_locks.h.
#pragma once

#include <cstdint>

namespace podm {

#ifdef PODM_INTERLEAVING
void step();
/// The attempt reads a cell, and relies on it until it calls forget_reads().
void note_read(std::uint32_t cell);
void forget_reads();
/// The attempt replaces a cell. Throws InternalError when another attempt relies on it.
void note_replaced(std::uint32_t cell);
/// 2 unless $PODM_PLANTED_FAULT or plant_locks_to_read() says otherwise: 1 for one_lock, 0 for no_lock.
/// Throws InputError when it names another fault.
unsigned locks_to_read();
void plant_locks_to_read(unsigned locks);
#else
inline void step() {}
inline void note_read(std::uint32_t) {}
inline void forget_reads() {}
inline void note_replaced(std::uint32_t) {}
constexpr unsigned locks_to_read() { return 2; }
#endif

}  // namespace podm
