// A mesh with a flat box in an oblique frame is turned for output, and rounding moves its vertices. Vertices
// that were on a sphere or just outside may then be inside: often there are none.
//
// Proposition: is_delaunay_when_turned() finds a vertex v of the output that is inside the sphere of a cell c
// of the output in the coordinates of the file, if there is one.
// Proof: Let pow(v, c) be the power of v with respect to the sphere of c before turning.
//   1. The store is Delaunay, so that pow(v, c) >= 0. Turning moves each vertex by at most e relative to the
//      others, except for a rotation. It changes the power by at most 2 e r (1 + the sum of |l|) to first
//      order, with r the radius of c and l the barycentric coordinates of v. Each of these is a ratio of
//      volumes, the greater of which is at most 3.08 r^3 / 6. So pow(v, c) is at most tau(c) = 100 e r^4 /
//      det, where det is six times the volume of c. If this is not far below r^2 for a cell, the function
//      returns false.
//   2. Walk along a line from a point of c to v. Powers of v with respect to the cells passed do not
//   increase,
//      and the last of these cells but one has v beyond a facet. So v is reached from the cell across a facet
//      that does not have it, by steps from cell to neighbor while the power is at most the largest tau, with
//      the errors of computed powers added.
// Each pair of a vertex and a cell that is found so is decided by the exact predicate. It counts vertices
// exactly on a sphere as inside or outside by its symbolic perturbation, so that the function may return
// false for a mesh that is Delaunay, but not true for one that is not.
#pragma once

#include "delaunay/mesh.h"
#include "geometry/point.h"
#include "isosurface/isosurface.h"
#include "podm/label_image.h"

namespace podm {

/// The place of a vertex in RAS, for images with is_turned_for_output(). Vertices on a side of the box stay
/// within two units in the last place of its plane.
Point turned(const LabelImage& image, const Point& p);

/// True if the cells that have a label are Delaunay, and positively oriented, in the coordinates of turned().
/// The mesh is Delaunay, and the labels of its cells are known. `threads`: 0 for all cores.
bool is_delaunay_when_turned(const Mesh& mesh, const LabelImage& image, int threads);

}  // namespace podm
