// Exact decisions about points with double coordinates. A filter decides first, exact arithmetic the cases
// that the filter leaves open. Every function counts these cases in `num_exact`.
#pragma once

#include <CGAL/Gmpq.h>
#include <CGAL/Interval_nt.h>

#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "mesh.h"

namespace podm::verify {

using Rational = CGAL::Gmpq;
using Interval = CGAL::Interval_nt<false>;  // inside Protect_FPU_rounding

/// Returns the sign of dot(cross(b-a, c-a), d-a).
int orientation(const Point& a, const Point& b, const Point& c, const Point& d, std::uint64_t& num_exact);
/// Returns 1 if p is strictly inside the circumsphere of the cell abcd, 0 on it, -1 outside, for either
/// orientation of the cell. The cell must not be flat.
int side_of_sphere(const Point& a, const Point& b, const Point& c, const Point& d, const Point& p,
                   std::uint64_t& num_exact);

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
/// Return the smaller and the larger of two numbers; for intervals, an interval that encloses it.
template <class T>
T smaller(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, Interval>) {
    return {std::min(a.inf(), b.inf()), std::min(a.sup(), b.sup())};
  } else {
    return b < a ? b : a;
  }
}
template <class T>
T larger(const T& a, const T& b) {
  return -smaller<T>(-a, -b);
}

/// A rational constant of a polynomial, for both types that sign_of() computes in.
class Constant {
 public:
  explicit Constant(Rational value) : exact_(std::move(value)), enclosure_(CGAL::to_interval(exact_)) {}
  template <class T>
  const T& in() const {
    if constexpr (std::is_same_v<T, Interval>) {
      return enclosure_;
    } else {
      return exact_;
    }
  }

 private:
  Rational exact_;
  Interval enclosure_;
};

/// Returns the sign of `polynomial(T{})`, a function that computes in the type of its argument. Intervals
/// prove the sign or leave it open; rationals decide open signs.
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

/// Returns the decimal number that a user typed to get this double, as a rational: 1.93 is 193/100.
Rational decimal_as_typed(double x);

/// Returns sin^2 of an angle of 0 to 90 degrees. It is exact at 0, 30, 45, 60 and 90, the only angles where
/// it is rational (Niven). Elsewhere it is a rational above sin^2 by less than 1e-70.
Rational squared_sine(const Rational& degrees);

}  // namespace podm::verify
