// Numbers for cells that are too flat for doubles.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/gmp.hpp>

#include "values/grid_overlap.h"

namespace podm {

/// 113 bits, those of IEEE's quadruple precision.
using Quad = boost::multiprecision::cpp_bin_float_quad;
using Rational = boost::multiprecision::mpq_rational;

template <>
inline int floor_of(const Rational& x) {
  const boost::multiprecision::mpz_int above = numerator(x), below = denominator(x);
  boost::multiprecision::mpz_int quotient = above / below;  // rounded towards 0
  if (quotient * below > above) --quotient;
  return static_cast<int>(quotient);
}

}  // namespace podm
