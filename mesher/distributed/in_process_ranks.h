// Ranks as threads of one process: the test bed of what is distributed, and a model of machines of many
// nodes.
//
// Each rank has a virtual clock, which goes on by the processor time of its thread between collectives and by
// what the rank charges. In a collective every clock becomes the latest of all, and then goes on by what the
// network would take, with a latency L and B bytes a second, P ranks and s = ceil(log2 P) steps (binomial
// trees and recursive doubling):
//
//   barrier        s L
//   sum, maximum   s (L + bytes / B)
//   all_gather     2 s L + (8 P + bytes that all tell) / B          lengths first
//   all_to_all     s (L + 4 P / B)                                  lengths first, then as the busiest rank:
//                  + the greatest L messages + bytes / B            of what a rank sends, or receives if that
//                  is more
//
// Empty messages and those to oneself are free. A collective lasts as long for all, so the model knows no
// overlap.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "distributed/communication.h"

namespace podm {

struct InProcessOptions {
  int num_ranks = 1;
  /// One rank computes at a time, from one collective to the next, so that many ranks on few processors do
  /// not slow each other down. Else the system decides.
  bool one_at_a_time = false;
  std::uint64_t seed =
      0;  ///< draws the order in which ranks compute, anew after every collective, if one at a time
  double latency_s = 0;
  double bytes_per_s = std::numeric_limits<double>::infinity();
};

/// Calls `body` for each rank on a thread of its own, and returns what each took, by rank, when all have
/// returned.
///
/// When a rank throws, the others' collectives throw RankFailed, now or when they next call one. Then it
/// throws what the first rank that failed threw, as the same of InputError, InternalError and std::bad_alloc,
/// else as std::runtime_error; what() begins with "rank 3 of 8: ". Ranks that call different collectives, and
/// a rank that returns where others still call, are InternalError. Throws InputError without a rank.
std::vector<RankReport> run_ranks(const InProcessOptions& options,
                                  const std::function<void(Communication&)>& body);

}  // namespace podm
