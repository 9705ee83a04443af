// A cell's circumcenter over any field that exact.h computes in.
#pragma once

#include <optional>

#include "geometry/measures.h"

namespace podm::verify {

/// These bound a number of any of the types.
inline double low(double x) { return x; }
inline double high(double x) { return x; }
inline double low(const Interval& x) { return x.inf(); }
inline double high(const Interval& x) { return x.sup(); }

/// Returns the circumcenter p[3] + sum / (2 determinant), with the terms of squared_circumradius(). Returns
/// nothing if the cell is flat, or if T is of intervals that leave this open.
template <class T>
std::optional<Vector<T>> circumcenter(const CellPoints& p) {
  const Vector<T> a = difference<T>(p[0], p[3]), b = difference<T>(p[1], p[3]), c = difference<T>(p[2], p[3]);
  const Vector<T> bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const T a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c), twice = T(2) * dot(a, bc);
  if constexpr (std::is_same_v<T, Interval>) {
    if (low(twice) <= 0 && high(twice) >= 0) return std::nullopt;
  } else {
    if (twice == T(0)) return std::nullopt;
  }
  Vector<T> center;
  for (std::size_t i = 0; i < 3; ++i) center[i] = T(p[3][i]) + (a2 * bc[i] + b2 * ca[i] + c2 * ab[i]) / twice;
  return center;
}

}  // namespace podm::verify
