// Exact decisions about points with double coordinates: a filter first, rationals for what it leaves open.
//
// Orientations and spheres are the LGPL kernel's of CGAL, filtered and exact. Other polynomials are evaluated
// in interval arithmetic, which proves its sign or not, and then in rationals.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Interval_nt.h>

#include <array>
#include <cstdint>

#include "mesh.h"

namespace podm::verify {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Rational = CGAL::Gmpq;
using Interval = CGAL::Interval_nt<false>;  // inside Protect_FPU_rounding

inline Kernel::Point_3 to_cgal(const Point& p) { return {p[0], p[1], p[2]}; }

/// The sign of dot(cross(b-a, c-a), d-a).
inline int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  return static_cast<int>(CGAL::orientation(to_cgal(a), to_cgal(b), to_cgal(c), to_cgal(d)));
}
/// 1 when p is strictly inside the circumsphere of the cell abcd of either orientation, 0 on it, -1 outside.
/// The cell must not be flat.
inline int side_of_sphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p) {
  return static_cast<int>(
      CGAL::side_of_bounded_sphere(to_cgal(a), to_cgal(b), to_cgal(c), to_cgal(d), to_cgal(p)));
}

/// A vector over any field.
template <class T>
using Vector = std::array<T, 3>;
template <class T>
Vector<T> difference(const Point& a, const Point& b) {
  return {T(a[0]) - T(b[0]), T(a[1]) - T(b[1]), T(a[2]) - T(b[2])};
}
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The sign of `polynomial(T{})`, a function that computes in the type of its argument. Counts what was left
/// to rationals.
template <class Polynomial>
int sign_of(const Polynomial& polynomial, std::uint64_t& num_exact) {
  {
    const CGAL::Protect_FPU_rounding<true> rounding_upwards;
    const Interval value = polynomial(Interval());
    if (value.inf() > 0) return 1;
    if (value.sup() < 0) return -1;
    if (value.inf() == 0 && value.sup() == 0) return 0;
  }
  ++num_exact;
  return static_cast<int>(CGAL::sign(polynomial(Rational())));
}

/// The decimal number that a person typed to get this double, as a rational: 1.93 is 193/100.
Rational typed_decimal(double x);

}  // namespace podm::verify
