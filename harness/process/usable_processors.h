#pragma once

#include <vector>

namespace podm::bench {

/// Returns the number of processors that this process may run on, at least 1.
int usable_processors();

/// Returns their numbers in ascending order; empty where the kernel does not report them.
std::vector<int> usable_processor_ids();

}  // namespace podm::bench
