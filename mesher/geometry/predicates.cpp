#include "geometry/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>

namespace podm {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactKernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;

Kernel::Point_3 convert(const Point& p) { return {p.x, p.y, p.z}; }
ExactKernel::Point_3 convert_exactly(const Point& p) { return {p.x, p.y, p.z}; }

// The sign of p's power against the cell once every height is perturbed. With barycentric coordinates
// lambda_i of p it is sign(sum lambda_i eps_i - eps_p): the largest point with a non-zero factor decides.
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
  return true;  // not reached: p itself always decides
}

}  // namespace

int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  return CGAL::orientation(convert(a), convert(b), convert(c), convert(d));
}

bool in_circumsphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p) {
  const CGAL::Oriented_side side =
      CGAL::side_of_oriented_sphere(convert(a), convert(b), convert(c), convert(d), convert(p));
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
