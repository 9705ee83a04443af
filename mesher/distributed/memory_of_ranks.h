// The memory that ranks need together.
#pragma once

#include <cmath>
#include <cstdint>

#include "algorithms/memory_model.h"

namespace podm {

/// Returns the number of ranks that can make a mesh of `mesh_cells` if each has `bytes` for its part.
/// Vertices of other ranks and uneven parts add up to a half.
inline std::uint64_t num_ranks_for(double mesh_cells, double bytes) {
  return static_cast<std::uint64_t>(std::ceil(1.5 * kPeakBytesPerMeshCell * mesh_cells / bytes));
}

}  // namespace podm
