// Ranks as threads of one process: the test bed of the distributed code, and a model of machines with many
// nodes.
//
// Each rank has a virtual clock. Between collectives it advances by the processor time of the rank's thread
// and by the time that the rank charges. If the rank's other threads are virtual, too, the clock advances by
// the time that all of them take (runtime/virtual_threads.h). Otherwise it does not include them. In a
// collective every clock is set to the latest clock of all ranks. It then advances by the simulated time on
// the network, with latency L, B bytes per second, P ranks and s = ceil(log2 P) steps (binomial trees and
// recursive doubling):
//
//   barrier        s L
//   sum, maximum   s (L + bytes / B)
//   all_gather     2 s L + (8 P + bytes of all messages) / B       lengths first
//   all_to_all     s (L + 4 P / B)                                 lengths first, then the busiest rank:
//                  + the greatest L messages + bytes / B           the larger of what a rank sends and
//                                                                  what it receives
//
// Empty messages and messages of a rank to itself are free. A collective takes the same time on all ranks, so
// the model has no overlap.
//
// Announcements are free. They arrive at once if ranks compute at the same time. If one rank computes at a
// time they arrive with the next collective, so that the order of the ranks does not change what they do.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "distributed/communication.h"

namespace podm {

struct InProcessOptions {
  int num_ranks = 1;
  /// True: one rank computes at a time, from one collective to the next, so that many ranks on few processors
  /// do not slow each other down. False: the system schedules the ranks.
  bool one_at_a_time = false;
  bool has_virtual_threads = false;  ///< the threads of a rank are virtual
  /// Draws the order in which ranks compute, anew after every collective, if one rank computes at a time.
  std::uint64_t seed = 0;
  double latency_s = 0;
  double bytes_per_s = std::numeric_limits<double>::infinity();
};

/// Calls `body` for each rank on a thread of its own. When all ranks have returned, returns their reports, by
/// rank.
///
/// When a rank throws, the current or next collective of every other rank throws RankFailed. The function
/// then throws the exception of the first rank that failed, with the same type if it is InputError,
/// InternalError or std::bad_alloc, otherwise as std::runtime_error; what() begins with "rank 3 of 8: ".
/// InternalError is thrown if ranks call different collectives, or if a rank returns while other ranks still
/// call collectives. Throws InputError if there is no rank.
std::vector<RankReport> run_ranks(const InProcessOptions& options,
                                  const std::function<void(Communication&)>& body);

}  // namespace podm
