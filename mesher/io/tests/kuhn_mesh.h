// Meshes for the tests: a grid of cubes, each cut into six tetrahedra along its diagonal (Kuhn), with a label
// a cube and the facets between labels.
#pragma once

#include <cstdint>
#include <functional>

#include "podm/tet_mesh.h"

namespace podm {

/// `label_of(i, j, k)` is the label of a cube of the n x n x n grid, 0 where there is none. Vertices are
/// displaced a little by `seed`, so that their coordinates use every bit. The labels of the result are
/// the background, "liver" (value 7), one without a name (value 3000000000) and "left kidney/2" (value 2).
TetMesh make_kuhn_mesh(int n, std::uint64_t seed, const std::function<LabelIndex(int, int, int)>& label_of);

/// Two labels side by side, a third inside them, and an empty corner.
TetMesh make_test_mesh(int n = 5, std::uint64_t seed = 1);

/// The same mesh in another order: vertices renumbered, cells and facets shuffled, the vertices of each
/// permuted evenly.
TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed);

/// Six times the signed volume.
double six_volumes(const std::array<double, 3>& a, const std::array<double, 3>& b,
                   const std::array<double, 3>& c, const std::array<double, 3>& d);
/// Volume of the cells of one label.
double volume_of_label(const TetMesh& mesh, LabelIndex label);

/// The same vertices, cells, labels by value, facets and pairs by value, in the same order.
bool same_mesh(const TetMesh& a, const TetMesh& b);

}  // namespace podm
