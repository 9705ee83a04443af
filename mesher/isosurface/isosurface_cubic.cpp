#include "isosurface/isosurface_cubic.h"

#include <cmath>

namespace podm {

namespace {

constexpr int kMaxHalvings = 20;
// A step this short leaves an error of the order of its square at a simple zero, and of its length at a
// double zero.
constexpr double kLastStep = 1e-9;

double middle(double a, double b) { return 0.5 * (a + b); }

// The only zero in (0,1) of a cubic that starts at or above zero and ends below zero. Takes Newton steps, and
// bisects where they leave the bracket.
double only_zero(const std::array<double, 4>& c, double end) {
  double low = 0, high = 1, s = c[0] / (c[0] - end);
  if (s > 0.99) s = 0.5;  // where the cubic ends almost at zero, a rounded value there has no meaning
  for (int i = 0; i < 60; ++i) {
    const double value = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
    (value >= 0 ? low : high) = s;
    const double step = value / (c[1] + s * (2 * c[2] + s * 3 * c[3]));
    if (!(s - step >= low && s - step <= high)) {
      s = middle(low, high);
    } else {
      s -= step;
      if (std::fabs(step) < kLastStep) break;
    }
  }
  return s;
}

// `b` are Bernstein coefficients. The cubic lies in their convex hull. The number of its zeros in (0,1) is at
// most the number of their sign changes, and has the same parity.
std::optional<double> first_fall_by_halves(const std::array<double, 4>& b, bool zero_holds, int halvings) {
  const auto is_low = [&](double value) { return zero_holds ? value < 0 : value <= 0; };
  if (is_low(b[0])) return 0;
  if (!is_low(b[1]) && !is_low(b[2]) && !is_low(b[3])) return std::nullopt;
  const bool is_monotone = is_low(b[1]) <= is_low(b[2]) && is_low(b[2]) <= is_low(b[3]);
  if (is_monotone) {
    const double d = b[2] - b[1];
    return only_zero({b[0], 3 * (b[1] - b[0]), 3 * (d - b[1] + b[0]), b[3] - b[0] - 3 * d}, b[3]);
  }
  if (halvings == kMaxHalvings) return std::nullopt;
  const double b01 = middle(b[0], b[1]), b12 = middle(b[1], b[2]), b23 = middle(b[2], b[3]);
  const double b012 = middle(b01, b12), b123 = middle(b12, b23), center = middle(b012, b123);
  if (const auto s = first_fall_by_halves({b[0], b01, b012, center}, zero_holds, halvings + 1)) {
    return 0.5 * *s;
  }
  if (const auto s = first_fall_by_halves({center, b123, b23, b[3]}, zero_holds, halvings + 1)) {
    return 0.5 + 0.5 * *s;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> first_fall(const std::array<double, 4>& c, bool zero_holds) {
  const double b1 = c[0] + c[1] * (1.0 / 3), b2 = b1 + (c[1] + c[2]) * (1.0 / 3);
  return first_fall_by_halves({c[0], b1, b2, c[0] + c[1] + c[2] + c[3]}, zero_holds, 0);
}

}  // namespace podm
