// The work of a mesh by place, as predicted from the image.
#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/construction.h"
#include "distributed/communication.h"
#include "distributed/cubes.h"

namespace podm {

/// Returns the number of cells that are predicted in each cube, in thousandths. Each rank predicts the cells
/// of its share of the cubes, on its `threads` threads, and all ranks get all numbers. Collective.
std::vector<std::uint64_t> predicted_work(const Problem& problem, const CubeGrid& grid, std::size_t threads,
                                          Communication& ranks);

}  // namespace podm
