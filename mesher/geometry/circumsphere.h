// Circumspheres: computed once when a cell is made, cached, and accurate enough for nearly every conflict
// test.
//
// Error bound. Let u = 2^-53, p the cell's last vertex, e1..e3 the vectors from p to the others, L = max
// |e_i|, det = e1.(e2 x e3), r the true circumradius, M the largest coordinate. The error of the center by
// the rounded formula below is at most
//     delta <= 90 u L^3 r / |det| + sqrt(3) u (M + r)
// (numerator: 36 u L^4 per component, |det| off by 16 u L^3, L <= 2r; last term: storing center + p). The
// power of a point x then changes by 2 delta (|x-c| + r). With delta <= tau r / 5, therefore,
//     |x-c|^2 < r^2 (1 - tau)  proves inside,   |x-c|^2 > r^2 (1 + tau)  proves outside.
// With tau = 2^-20 this holds if L^3 <= 1e7 |det| and M <= 1e8 r: the sphere is *certified*. Other cells
// (about one in 10^5) get the exact center, rounded once (delta <= sqrt(3) u (M + r)). A sphere that is not
// certified even then has a squared radius of NaN. All tests against it are then undecided, and therefore
// exact.
//
// The store keeps r^2 as a float f = r^2 (1 + e), |e| <= 2^-24, if f is a normal number; otherwise the sphere
// is not certified. With tau' = tau + 2^-23 in place of tau, f proves the same as r^2:
// f (1 - tau') <= r^2 (1 - tau) and f (1 + tau') >= r^2 (1 + tau), including the rounding of the product,
// 2^-53. Each inequality therefore proves its side. The points between the two bounds, an eighth more than
// before, are left to the exact predicate.
#pragma once

#include <algorithm>
#include <limits>

#include "geometry/point.h"
#include "geometry/predicates.h"

namespace podm {

inline constexpr double kSphereTolerance = 1.0 / (1 << 20);                           // tau
inline constexpr double kStoredSphereTolerance = kSphereTolerance + 1.0 / (1 << 23);  // tau'

struct Circumsphere {
  Point center;
  double squared_radius = 0;  // NaN: not certified
};

enum class Side { kInside, kOutside, kUndecided };

inline Side side_of(const Circumsphere& s, const Point& p) {
  const double d = squared_distance(s.center, p);
  if (d < s.squared_radius * (1 - kSphereTolerance)) return Side::kInside;
  if (d > s.squared_radius * (1 + kSphereTolerance)) return Side::kOutside;
  return Side::kUndecided;
}
/// Decides the same for a stored sphere.
inline Side side_of(const Point& center, float squared_radius, const Point& p) {
  const double d = squared_distance(center, p), r2 = squared_radius;
  if (d < r2 * (1 - kStoredSphereTolerance)) return Side::kInside;
  if (d > r2 * (1 + kStoredSphereTolerance)) return Side::kOutside;
  return Side::kUndecided;
}

/// Returns the squared radius for the store: NaN unless it is certified and a normal float.
inline float stored_squared_radius(double squared_radius) {
  using Float = std::numeric_limits<float>;
  const bool is_normal = squared_radius >= Float::min() && squared_radius <= Float::max();
  return is_normal ? static_cast<float>(squared_radius) : Float::quiet_NaN();
}

/// The result of the rounded formula relative to the origin p, without certificate: center - p, det and L^2.
struct RelativeSphere {
  Vector center;
  double determinant, squared_length;  // det and L^2
};
inline RelativeSphere relative_sphere(const Vector& e1, const Vector& e2, const Vector& e3, double s1,
                                      double s2, double s3) {
  const Vector x1 = cross(e2, e3), x2 = cross(e3, e1), x3 = cross(e1, e2);
  const double det = dot(e1, x1);
  const double scale = 0.5 / det;
  const double longest = s2 < s3 ? s3 : s2;  // no std::max: its references prevent vector loops
  return {{scale * (s1 * x1.x + s2 * x2.x + s3 * x3.x), scale * (s1 * x1.y + s2 * x2.y + s3 * x3.y),
           scale * (s1 * x1.z + s2 * x2.z + s3 * x3.z)},
          det,
          longest < s1 ? s1 : longest};
}
inline bool is_well_conditioned(double det, double squared_length) {
  return squared_length * squared_length * squared_length <= 1e14 * det * det;
}

/// True if the sphere's squared radius is large enough for `extent`, which is M, the largest coordinate.
inline bool is_certified(double squared_radius, double extent) {
  return squared_radius * 1e16 >= extent * extent;
}
inline double certified_squared_radius(const Point& center, const Point& p, double extent) {
  const double r2 = squared_distance(center, p);
  return is_certified(r2, extent) ? r2 : std::numeric_limits<double>::quiet_NaN();
}

/// Returns the circumsphere of the positive cell (a,b,c,p).
inline Circumsphere circumsphere(const Point& a, const Point& b, const Point& c, const Point& p,
                                 double extent) {
  const Vector e1 = a - p, e2 = b - p, e3 = c - p;
  const RelativeSphere s =
      relative_sphere(e1, e2, e3, squared_length(e1), squared_length(e2), squared_length(e3));
  const Point center =
      is_well_conditioned(s.determinant, s.squared_length) ? p + s.center : exact_circumcenter(a, b, c, p);
  return {center, certified_squared_radius(center, p, extent)};
}

}  // namespace podm
