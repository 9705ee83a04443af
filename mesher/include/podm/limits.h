// What ends a run early.
#pragma once

#include <cstdint>

namespace podm {

/// Each ends a run early, with a valid Delaunay mesh that says what is unmet. 0: no limit.
struct Limits {
  std::uint64_t max_elements = 0;
  double max_seconds = 0;
  std::uint64_t max_memory_bytes = 0;  ///< image and transform come on top
};

}  // namespace podm
