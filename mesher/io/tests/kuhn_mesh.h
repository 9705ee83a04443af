// Meshes for the tests: a grid of cubes, each cut into six tetrahedra along its diagonal (Kuhn), with one
// label per cube and the facets between labels.
#pragma once

#include <cstdint>
#include <functional>

#include "podm/tet_mesh.h"

namespace podm {

/// Returns a mesh of the n x n x n grid. `label_of(i, j, k)` is the label of a cube; 0: no cube. `seed`
/// displaces the vertices slightly, so that their coordinates use every bit. The labels of the result are the
/// background, "liver" (value 7), one without a name (value 3000000000) and "left kidney/2" (value 2).
TetMesh make_kuhn_mesh(int n, std::uint64_t seed, const std::function<LabelIndex(int, int, int)>& label_of);

/// Returns two labels side by side, a third inside them, and an empty corner.
TetMesh make_test_mesh(int n = 5, std::uint64_t seed = 1);

/// Adds the edges around which three or more labels meet as lines.
void add_lines(TetMesh& mesh);

/// Returns the same mesh in another order: vertices renumbered, cells and facets shuffled, the vertices of
/// each permuted evenly.
TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed);

/// Returns six times the signed volume.
double six_volumes(const std::array<double, 3>& a, const std::array<double, 3>& b,
                   const std::array<double, 3>& c, const std::array<double, 3>& d);
/// Returns the volume of the cells of one label.
double volume_of_label(const TetMesh& mesh, LabelIndex label);

/// Returns true if both have the same vertices, cells, labels by value, facets and pairs by value, lines by
/// the values of their labels, in the same order.
bool same_mesh(const TetMesh& a, const TetMesh& b);

}  // namespace podm
