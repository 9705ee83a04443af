// Ranks as threads of one process.
#pragma once

#include <functional>

#include "ranks/communication.h"

namespace podm::verify {

/// Calls `body` for each rank on a thread of its own, and returns when all have returned. If a rank throws,
/// the current or next collective of every other rank throws RankFailed, and the exception of the first rank
/// that failed is thrown here. A collective also throws RankFailed once a rank has returned.
void run_ranks(int num_ranks, const std::function<void(Communication&)>& body);

}  // namespace podm::verify
