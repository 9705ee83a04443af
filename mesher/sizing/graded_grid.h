// Limits how fast numbers at the nodes of a grid grow from node to node.
#pragma once

#include <array>
#include <vector>

namespace podm {

/// Lowers `values` to the largest numbers that exceed each other by at most `slope` times their distance. The
/// distance is the length of the shortest path over neighbors (26 per node), divided by graded_stretch(). It
/// is therefore at most the straight distance, and at least 1 / graded_stretch() of it. `spacing` is the
/// distance between nodes, in any unit, along orthogonal axes. Values may be infinite.
void grade(const std::array<int, 3>& size, const std::array<double, 3>& spacing, double slope,
           std::vector<float>& values);

/// The largest ratio of a path over neighbors to the straight one; 1.128 where spacings are equal.
double graded_stretch(const std::array<double, 3>& spacing);

}  // namespace podm
