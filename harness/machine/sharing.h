// The costs of what threads of one process share: cache lines that they write, and the system's memory map.
#pragma once

#include "rows/fields.h"

namespace podm::bench {

/// The record of `podm-bench sharing`. Nanoseconds, medians of several repeats.
struct SharingRecord {
  int processors = 0;  ///< on which the two threads ran; 1: times of two threads mean nothing
  // An atomic addition:
  double addition_alone_ns = 0;     ///< by one thread
  double addition_separate_ns = 0;  ///< by each of two threads, in lines of their own
  double addition_shared_ns = 0;    ///< between two additions by any of two threads in one line
  double transfer_ns = 0;           ///< from a thread's write until the other thread has read it and written
  // A load by one thread, with an addition between two loads, while another thread writes a word:
  double load_beside_writer_ns = 0;      ///< a word of the same line
  double load_apart_from_writer_ns = 0;  ///< a word of another line
  // The first touch of a page of 4 KiB, and a later one:
  double page_fault_ns = 0;          ///< by one thread
  double page_fault_by_each_ns = 0;  ///< by each of two threads that touch new pages at the same time
  double page_touched_again_ns = 0;
  // A chunk of 64 KiB, all of whose pages are touched:
  double mapped_chunk_ns = 0;    ///< mapped before, and unmapped afterwards
  double recycled_chunk_ns = 0;  ///< mapped once
  static constexpr auto fields() {
    return PODM_FIELDS(SharingRecord, processors, addition_alone_ns, addition_separate_ns, addition_shared_ns,
                       transfer_ns, load_beside_writer_ns, load_apart_from_writer_ns, page_fault_ns,
                       page_fault_by_each_ns, page_touched_again_ns, mapped_chunk_ns, recycled_chunk_ns);
  }
};

/// Takes about 2 s. Throws std::bad_alloc, std::system_error.
SharingRecord measure_sharing();

}  // namespace podm::bench
