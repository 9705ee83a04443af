#include "image/isosurface_cubic.h"

#include <cmath>

namespace podm {

namespace {

constexpr int kMaxHalvings = 20;
constexpr double kTolerance = 1e-12;

double middle(double a, double b) { return 0.5 * (a + b); }

// The only zero in (0,1) of a cubic that starts at or above zero and ends below: Newton's steps, and
// bisection where they leave the bracket.
double only_zero(const BernsteinCubic& b) {
  const double c1 = 3 * (b[1] - b[0]), c2 = 3 * (b[2] - 2 * b[1] + b[0]),
               c3 = b[3] - b[0] - 3 * (b[2] - b[1]);
  double low = 0, high = 1, s = b[0] / (b[0] - b[3]);
  for (int i = 0; i < 60; ++i) {
    const double value = b[0] + s * (c1 + s * (c2 + s * c3));
    (value >= 0 ? low : high) = s;
    double next = s - value / (c1 + s * (2 * c2 + s * 3 * c3));
    if (!(next >= low && next <= high)) next = middle(low, high);
    if (std::fabs(next - s) < kTolerance) return next;
    s = next;
  }
  return s;
}

std::optional<double> first_fall(const BernsteinCubic& b, bool zero_holds, int halvings) {
  const auto is_low = [&](double value) { return zero_holds ? value < 0 : value <= 0; };
  if (is_low(b[0])) return 0;
  int changes = 0;
  for (std::size_t i = 0; i < 3; ++i) changes += is_low(b[i]) != is_low(b[i + 1]);
  if (changes == 0) return std::nullopt;
  if (changes == 1) return only_zero(b);
  if (halvings == kMaxHalvings) return std::nullopt;
  const double b01 = middle(b[0], b[1]), b12 = middle(b[1], b[2]), b23 = middle(b[2], b[3]);
  const double b012 = middle(b01, b12), b123 = middle(b12, b23), center = middle(b012, b123);
  if (const auto s = first_fall({b[0], b01, b012, center}, zero_holds, halvings + 1)) return 0.5 * *s;
  if (const auto s = first_fall({center, b123, b23, b[3]}, zero_holds, halvings + 1)) return 0.5 + 0.5 * *s;
  return std::nullopt;
}

}  // namespace

// The interpolation is affine in each coordinate, hence its own polar form: the coefficients average its
// values where some coordinates are those of p and the others those of q.
BernsteinCubic along_segment(const CornerValues& v, const Point& p, const Point& q) {
  // Corners of the box spanned by p and q, ordered as those of a block.
  CornerValues x, y, z;
  for (std::size_t e = 0; e < 8; e += 2) {
    x[e] = interpolate(v[e], v[e + 1], p.x);
    x[e + 1] = interpolate(v[e], v[e + 1], q.x);
  }
  for (const std::size_t e : {0u, 1u, 4u, 5u}) {
    y[e] = interpolate(x[e], x[e + 2], p.y);
    y[e + 2] = interpolate(x[e], x[e + 2], q.y);
  }
  for (const std::size_t e : {0u, 1u, 2u, 3u}) {
    z[e] = interpolate(y[e], y[e + 4], p.z);
    z[e + 4] = interpolate(y[e], y[e + 4], q.z);
  }
  return {z[0], (z[1] + z[2] + z[4]) / 3, (z[3] + z[5] + z[6]) / 3, z[7]};
}

std::optional<double> first_fall(const BernsteinCubic& cubic, bool zero_holds) {
  return first_fall(cubic, zero_holds, 0);
}

}  // namespace podm
