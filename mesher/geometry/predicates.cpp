#include "geometry/predicates.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace podm {

namespace {

using ExactKernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;

ExactKernel::Point_3 convert_exactly(const Point& p) { return {p.x, p.y, p.z}; }

// Error bounds of determinants in rounded arithmetic, relative to the sum of the absolute values of their
// products: Shewchuk, Discrete & Computational Geometry 18 (1997) 305-363, stage A. Unlike interval
// arithmetic, they need no rounding mode, which tools that simulate a processor ignore.
constexpr double kEpsilon = 0x1p-53;
constexpr double kOrientationError = (7 + 56 * kEpsilon) * kEpsilon;
constexpr double kSphereError = (16 + 224 * kEpsilon) * kEpsilon;
constexpr double kUnderflow = 1e-290;  // far above the error that underflowing products can add

// A sum of products, and the sum of their absolute values.
struct Sum {
  double value = 0, size = 0;

  std::optional<int> sign(double relative_error) const {
    const double error = relative_error * size + kUnderflow;
    if (value > error) return 1;
    if (-value > error) return -1;
    return std::nullopt;
  }
};

// Returns one component of the cross product of two vectors.
Sum minor(double a, double b, double c, double d) {
  const double first = a * d, second = b * c;
  return {first - second, std::fabs(first) + std::fabs(second)};
}

// dot(cross(u, v), w)
Sum determinant(const Vector& u, const Vector& v, const Vector& w) {
  const Sum x = minor(u.y, u.z, v.y, v.z), y = minor(u.z, u.x, v.z, v.x), z = minor(u.x, u.y, v.x, v.y);
  return {w.x * x.value + w.y * y.value + w.z * z.value,
          std::fabs(w.x) * x.size + std::fabs(w.y) * y.size + std::fabs(w.z) * z.size};
}

// True if the four points have one coordinate in common, as those on a flat face of voxels do. Filters cannot
// decide that their determinant is 0.
bool are_in_plane_of_axes(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto are_equal = [](double i, double j, double k, double l) { return i == j && i == k && i == l; };
  return are_equal(a.x, b.x, c.x, d.x) || are_equal(a.y, b.y, c.y, d.y) || are_equal(a.z, b.z, c.z, d.z);
}

// Returns the power of p, the origin of all four vectors, against the circumsphere of a positive cell;
// positive inside.
Sum power(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  const Sum without_a = determinant(b, c, d), without_b = determinant(a, c, d),
            without_c = determinant(a, b, d), without_d = determinant(a, b, c);
  const double a2 = squared_length(a), b2 = squared_length(b), c2 = squared_length(c), d2 = squared_length(d);
  return {(a2 * without_a.value - b2 * without_b.value) + (c2 * without_c.value - d2 * without_d.value),
          a2 * without_a.size + b2 * without_b.size + c2 * without_c.size + d2 * without_d.size};
}

// True if p is inside once every height is perturbed. With barycentric coordinates lambda_i of p, it is
// inside if sum lambda_i eps_i - eps_p < 0: the largest point with a non-zero factor decides.
bool in_perturbed_circumsphere(const std::array<const Point*, 4>& cell, const Point& p) {
  std::array<const Point*, 5> by_size{cell[0], cell[1], cell[2], cell[3], &p};
  std::sort(by_size.begin(), by_size.end(),
            [](const Point* a, const Point* b) { return lexicographically_less(*b, *a); });
  for (const Point* largest : by_size) {
    if (largest == &p) return true;
    std::array<const Point*, 4> replaced = cell;
    std::replace(replaced.begin(), replaced.end(), largest, &p);
    const int lambda = orientation(*replaced[0], *replaced[1], *replaced[2], *replaced[3]);
    if (lambda != 0) return lambda < 0;
  }
  return true;  // unreachable: p itself always decides
}

}  // namespace

int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (const auto sign = determinant(b - a, c - a, d - a).sign(kOrientationError)) return *sign;
  if (are_in_plane_of_axes(a, b, c, d)) return 0;
  return CGAL::orientation(convert_exactly(a), convert_exactly(b), convert_exactly(c), convert_exactly(d));
}

bool in_circumsphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p) {
  if (const auto sign = power(a - p, b - p, c - p, d - p).sign(kSphereError)) return *sign > 0;
  const CGAL::Oriented_side side = CGAL::side_of_oriented_sphere(
      convert_exactly(a), convert_exactly(b), convert_exactly(c), convert_exactly(d), convert_exactly(p));
  if (side != CGAL::ON_ORIENTED_BOUNDARY) return side == CGAL::ON_POSITIVE_SIDE;
  if (p == a || p == b || p == c || p == d) return false;
  return in_perturbed_circumsphere({&a, &b, &c, &d}, p);
}

Point exact_circumcenter(const Point& a, const Point& b, const Point& c, const Point& d) {
  const ExactKernel::Point_3 center =
      CGAL::circumcenter(convert_exactly(a), convert_exactly(b), convert_exactly(c), convert_exactly(d));
  return {CGAL::to_double(center.x()), CGAL::to_double(center.y()), CGAL::to_double(center.z())};
}

}  // namespace podm
