// Exact predicates. The filters in front of them are in circumsphere.h and hole.cpp.
#pragma once

#include "geometry/point.h"

namespace podm {

/// Returns the sign of dot(cross(b-a, c-a), d-a): +1, 0 or -1, exact.
int orientation(const Point& a, const Point& b, const Point& c, const Point& d);

/// True if p lies inside the circumsphere of the positive cell (a,b,c,d), exact. Symbolic perturbation
/// decides for cospherical points and makes the Delaunay triangulation of any point set unique: the lifted
/// height |x|^2 of every point is lowered by an infinitesimal, which is infinitely larger for a
/// lexicographically larger point (idea: Devillers and Teillaud, "Perturbations for Delaunay and weighted
/// Delaunay 3D triangulations", CGTA 44 (2011)). Heights are then generic, so no flat cell is ever Delaunay
/// off the hull. A point that coincides with a vertex is in no sphere.
bool in_circumsphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p);

/// Returns the circumcenter of a cell, computed exactly and rounded once. Slow; (a,b,c,d) must not be
/// coplanar.
Point exact_circumcenter(const Point& a, const Point& b, const Point& c, const Point& d);

}  // namespace podm
