// The processors that this process may run on.
#pragma once

#include <vector>

namespace podm::bench {

/// Processors that this process may run on, at least 1.
int usable_processors();

/// Their numbers, the lowest first; none where the kernel does not tell.
std::vector<int> usable_processor_ids();

}  // namespace podm::bench
