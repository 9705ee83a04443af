// Numbers at the nodes of a grid that grow no faster than some slope from node to node.
#pragma once

#include <array>
#include <vector>

namespace podm {

/// Lowers `values` to the largest that are no more than `slope` times the distance above each other, for a
/// distance that is no longer than the straight one, and no shorter than 1 / graded_stretch() of it: the
/// length of the shortest way over neighbours, 26 of each node, divided by graded_stretch(). `spacing`:
/// between nodes, of any unit, along axes that are orthogonal. Infinity is a number, too.
void grade(const std::array<int, 3>& size, const std::array<double, 3>& spacing, double slope,
           std::vector<float>& values);

/// The most by which a way over neighbours is longer than the straight one; 1.128 where spacings are equal.
double graded_stretch(const std::array<double, 3>& spacing);

}  // namespace podm
