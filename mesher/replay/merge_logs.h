// Merges the logs of ranks that share no memory into one: the serial run that they claim to equal.
//
// In the first step each rank inserts seeds in and around its part of space, and some farther away. A seed
// may be in several logs; the whole has it once. Then all ranks take steps together. In a step each rank
// either changes the mesh within a part of space that no other rank changes in this step, or learns from
// other ranks what they have changed. Operations of different ranks in one step therefore change no vertex in
// common, and any order of them makes the same mesh. Here they are ordered by rank.
//
// Each rank has its own numbers of vertices. In the whole a vertex is identified by its point: vertices that
// exist at the same time have different points. A removed vertex may come back, therefore the step decides.
// Everything that a rank has learnt is compared with the whole as it was at that time. A rank that received
// wrong data is therefore found, even if the wrong data had no effect. Seeds are no such data: a rank that
// lacks a seed of another rank, or has one more, is found only if the mesh differs from its replay.
#pragma once

#include <string>
#include <vector>

#include "podm/operation_log.h"

namespace podm {

struct LogOfRank {
  std::string path;  ///< for messages
  OperationLog log;
};

/// The operations of all logs of a run, with the vertex numbers of the whole, and the head of rank 0's log.
/// Sequence numbers stay those of each rank. Workers are numbered by worker_in_whole(). The log of a run on
/// one machine is returned unchanged. `logs` are in any order, at least one, of the same run, one log per
/// rank. Throws InputError, naming path and operation, if the logs are not of one run or do not fit together.
OperationLog merge_logs(std::vector<LogOfRank> logs);

/// The number of a rank's worker among all workers: the rank is in the high 16 bits.
inline constexpr unsigned kBitsInWorker = 16;
inline std::uint32_t worker_in_whole(int rank, std::uint32_t worker) {
  return static_cast<std::uint32_t>(rank) << kBitsInWorker | (worker & ((1u << kBitsInWorker) - 1));
}

}  // namespace podm
