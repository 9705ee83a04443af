// The extremes of a cell's dihedral angles, and a measure of the worst angle. They are compared without roots
// and arc functions.
//
// Consider the edge of length L between the facets with inward normals n and m. Then n x m is the edge times
// det = 6 volumes, so the angle t there has cot t = -n.m / (det L). The square of cot t, with its sign, falls
// as t grows from 0 to 180 degrees, and 1 / sin^2 t = 1 + cot^2 t.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/point.h"

namespace podm {

inline constexpr double kRadToDeg = 180 / std::numbers::pi;

/// Returns the square of an angle's cotangent, with its sign, from the cotangent's numerator and its squared
/// denominator. Returns infinity, the value of the least angle, where there is no angle.
inline double signed_square_ratio(double numerator, double squared_denominator) {
  const double squared = numerator * std::abs(numerator) / squared_denominator;
  return squared == squared ? squared : std::numeric_limits<double>::infinity();
}
/// Returns the angle with the given squared cotangent, 0 to 180 degrees.
inline double angle_deg(double cotangent2) {
  return std::atan2(1, std::copysign(std::sqrt(std::abs(cotangent2)), cotangent2)) * kRadToDeg;
}

/// The extremes of a cell's six dihedral angles, as squared cotangents with their signs.
struct DihedralExtremes {
  double of_least, of_largest;
  double determinant;  // positive for a positive cell

  double least_deg() const { return angle_deg(of_least); }
  double largest_deg() const { return angle_deg(of_largest); }
};

/// Has no branch and no loop: compilers vectorize a loop over it. A flat cell has angles of 0 and 180.
inline DihedralExtremes dihedral_extremes(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Vector ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b, cd = d - c;
  // Normals of the facets opposite a, b, c and d. Two facets meet at the edge between the other two vertices.
  const Vector na = cross(bd, bc), nb = cross(ac, ad), nc = cross(ad, ab), nd = cross(ab, ac);
  const double det = dot(nd, ad), det2 = det * det;
  const double at_cd = signed_square_ratio(-dot(na, nb), det2 * squared_length(cd)),
               at_bd = signed_square_ratio(-dot(na, nc), det2 * squared_length(bd)),
               at_bc = signed_square_ratio(-dot(na, nd), det2 * squared_length(bc)),
               at_ad = signed_square_ratio(-dot(nb, nc), det2 * squared_length(ad)),
               at_ac = signed_square_ratio(-dot(nb, nd), det2 * squared_length(ac)),
               at_ab = signed_square_ratio(-dot(nc, nd), det2 * squared_length(ab));
  const auto less = [](double x, double y) { return x < y ? x : y; };  // no std::min: its references prevent
  const auto more = [](double x, double y) { return x > y ? x : y; };  // vector loops
  return {more(more(more(at_cd, at_bd), more(at_bc, at_ad)), more(at_ac, at_ab)),
          less(less(less(at_cd, at_bd), less(at_bc, at_ad)), less(at_ac, at_ab)), det};
}

/// The bounds of all dihedral angles, and a measure of the worse of the two extremes: the sine of each
/// extreme is divided by the sine of its own bound.
class DihedralBounds {
 public:
  /// Degrees, 0 < least < 90 < largest < 180.
  DihedralBounds(double least_deg, double largest_deg)
      : least_deg_(least_deg),
        largest_deg_(largest_deg),
        squared_sine_of_least_(squared_sine(least_deg)),
        squared_sine_of_largest_(squared_sine(largest_deg)) {}

  double least_deg() const { return least_deg_; }
  double largest_deg() const { return largest_deg_; }

  /// Returns (sin t / sin bound)^2 for the angle t with the given squared cotangent, where the bound is the
  /// one on t's side of 90 degrees: 1 at the bound, less beyond it.
  double quality_of_angle(double cotangent2) const {
    return 1 / ((cotangent2 < 0 ? squared_sine_of_largest_ : squared_sine_of_least_) *
                (1 + std::abs(cotangent2)));
  }
  /// Returns quality_of_angle() of the cell's worst dihedral angle; 0 for a flat or inverted cell.
  double quality(const DihedralExtremes& cell) const {
    if (!(cell.determinant > 0)) return 0;
    return std::min(quality_of_angle(cell.of_least), quality_of_angle(cell.of_largest));
  }

 private:
  static double squared_sine(double degrees) {
    const double sine = std::sin(degrees / kRadToDeg);
    return sine * sine;
  }

  double least_deg_, largest_deg_, squared_sine_of_least_, squared_sine_of_largest_;
};

}  // namespace podm
