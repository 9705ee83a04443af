// The places where a worker reads or writes what others share. In an ordinary build there is nothing to them.
//
// With PODM_INTERLEAVING another worker may go on at each of them, as it would with a core to each worker: a
// thread yields now and then, and an attempt in virtual time (workers/virtual_time.h) stops there and goes on
// later. What that attempt has read must be as it was until it is over: replacing a cell that another has
// read is an error.
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
#else
inline void step() {}
inline void note_read(std::uint32_t) {}
inline void forget_reads() {}
inline void note_replaced(std::uint32_t) {}
#endif

}  // namespace podm
