// Exact decisions. The filters in front of them live with their callers (circumsphere.h, hole.cpp).
#pragma once

#include "geometry/point.h"

namespace podm {

/// Sign of dot(cross(b-a, c-a), d-a): +1, 0 or -1, exact.
int orientation(const Point& a, const Point& b, const Point& c, const Point& d);

/// Whether p lies inside the circumsphere of the positive cell (a,b,c,d), exact. Cospherical points are told
/// apart by symbolic perturbation, so that the Delaunay triangulation of any point set is unique: the lifted
/// height |x|^2 of every point is lowered by an infinitesimal, infinitely larger for a lexicographically
/// larger point (idea: Devillers and Teillaud, "Perturbations for Delaunay and weighted Delaunay 3D
/// triangulations", CGTA 44 (2011)). Heights are generic then, so no flat cell is ever Delaunay off the hull.
/// A point that coincides with a vertex is in no sphere.
bool in_circumsphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p);

/// Circumcentre of a cell, computed exactly and rounded once. Slow; (a,b,c,d) must not be coplanar.
Point exact_circumcenter(const Point& a, const Point& b, const Point& c, const Point& d);

}  // namespace podm
