// Points of a curve within a block, from the places where the lattice sees it.
#pragma once

#include <vector>

#include "geometry/box.h"
#include "geometry/point.h"
#include "lines/lattice.h"
#include "lines/weight_forms.h"

namespace podm {

/// Greatest distance of a point from the triangle of the lattice for which it is sought.
inline constexpr double kCurveReach = 3 * kLatticeSide;

/// The places of a curve on the lattice, in their order, and its ends, all relative to the block.
struct LatticeCurve {
  SlotMask labels = 0;  // that meet along it
  std::vector<Point> places;
  std::vector<Point> first, last;  // the ends' points: none or one each
  bool is_closed = false;
};

struct CurvePoints {
  std::vector<Point> points;       // closed: first == last
  std::vector<Point> unconfirmed;  // middles of stretches along which no point was found
};

/// Finds points in `box` where the labels tie. Where none is found over a distance of kLongestGap the curve
/// follows its places. Chords leave the curve by about kSimplifyTolerance.
CurvePoints curve_points(const WeightForms& forms, const Box& box, const LatticeCurve& curve);

}  // namespace podm
