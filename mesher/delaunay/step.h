// The places where a worker reads or writes shared data. In an ordinary build they do nothing.
//
// With PODM_INTERLEAVING another worker may go on at each of them, as it could if each worker had its own
// core: a thread yields now and then, and an attempt in virtual time (workers/virtual_time.h) stops there and
// goes on later. The data that an attempt has read must stay unchanged until the attempt is over: replacing a
// cell that another attempt has read is an error.
#pragma once

#include <cstdint>

namespace podm {

#ifdef PODM_INTERLEAVING
void step();
/// Notes that the attempt reads a cell, and relies on it until it calls forget_reads().
void note_read(std::uint32_t cell);
void forget_reads();
/// Notes that the attempt replaces a cell. Throws InternalError if another attempt relies on the cell.
void note_replaced(std::uint32_t cell);
#else
inline void step() {}
inline void note_read(std::uint32_t) {}
inline void forget_reads() {}
inline void note_replaced(std::uint32_t) {}
#endif

}  // namespace podm
