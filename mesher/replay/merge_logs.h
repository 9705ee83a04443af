// The logs of ranks that share no memory become one: the serial run that they claim to equal.
//
// The first rank makes a coarse mesh, and then all take steps together. In a step each rank either changes
// the mesh within a part of space that no other changes in this step, or learns from others what they have
// changed. So operations of different ranks in one step change no vertex in common, and any order of them
// makes the same mesh; it is by rank here.
//   Numbers of vertices are each rank's own. In the whole a vertex is where it is: vertices that are there at
//   the same time are at different points, and a removed one may come back, so it is the step that decides.
//   What a rank has learnt is compared with the whole, as it was at that time: so a rank that has been told
//   wrong is found, even if nothing came of it.
#pragma once

#include <string>
#include <vector>

#include "podm/operation_log.h"

namespace podm {

struct LogOfRank {
  std::string path;  ///< for messages
  OperationLog log;
};

/// The operations of all logs of a run, with the numbers of the whole's vertices, and the head of rank 0's.
/// Sequence numbers stay each rank's; workers are numbered by worker_in_whole(). The log of a run on one
/// machine is returned as it is. `logs` are in any order, at least one, of the same run, one a rank. Throws
/// InputError, naming path and operation, unless they are and fit together.
OperationLog merge_logs(std::vector<LogOfRank> logs);

/// A worker of a rank among all: the rank in the high 16 bits.
inline constexpr unsigned kBitsInWorker = 16;
inline std::uint32_t worker_in_whole(int rank, std::uint32_t worker) {
  return static_cast<std::uint32_t>(rank) << kBitsInWorker | (worker & ((1u << kBitsInWorker) - 1));
}

}  // namespace podm
