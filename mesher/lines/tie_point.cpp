#include "lines/tie_point.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace podm {

namespace {

constexpr std::size_t kMostEquations = 3;
constexpr int kMostSteps = 16;
constexpr double kLongestStep = 0.25;      // of the block's side, as all lengths here
constexpr double kConverged = 1e-10;       // length of a step
constexpr double kTolerance = 1e-9;        // of weights, relative to their sum; and of places
constexpr double kRegularisation = 1e-14;  // relative to the trace: equations may depend on each other

using Matrix = std::array<std::array<double, kMostEquations>, kMostEquations>;

// Solves a x = b in place for a symmetric positive definite `a` of n rows, by Cholesky's factors.
void solve(Matrix& a, std::array<double, kMostEquations>& b, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(std::max(a[j][j], 1e-300));
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
}

// The differences between the first tied label's weight and those of the others.
class Differences {
 public:
  Differences(const WeightForms& forms, SlotMask tied) {
    const auto first = static_cast<std::size_t>(std::countr_zero(tied));
    for (std::size_t s = first + 1; s < forms.size(); ++s) {
      if ((tied >> s & 1) == 0) continue;
      CornerValues values;
      for (std::size_t c = 0; c < 8; ++c) values[c] = forms.corners(first)[c] - forms.corners(s)[c];
      differences_[size_++] = Trilinear(values);
    }
  }

  /// The shortest step from f that makes all linearised differences 0.
  Vector step(const Point& f) const {
    std::array<Vector, kMostEquations> gradient;
    std::array<double, kMostEquations> value{};
    for (std::size_t i = 0; i < size_; ++i) {
      gradient[i] = differences_[i].gradient(f);
      value[i] = differences_[i].value(f);
    }
    Matrix normal{};
    double trace = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      for (std::size_t j = 0; j <= i; ++j) normal[i][j] = dot(gradient[i], gradient[j]);
      trace += normal[i][i];
    }
    for (std::size_t i = 0; i < size_; ++i) normal[i][i] += kRegularisation * trace;
    solve(normal, value, size_);
    Vector d;
    for (std::size_t i = 0; i < size_; ++i) d = d - value[i] * gradient[i];
    return d;
  }

 private:
  static constexpr Trilinear kZero{CornerValues{}};
  std::array<Trilinear, kMostEquations> differences_{kZero, kZero, kZero};
  std::size_t size_ = 0;
};

// True if the tied labels have equal weights at f, and none exceeds them.
bool is_tie(const WeightForms& forms, SlotMask tied, const Point& f) {
  double sum = 0, greatest = 0, least_tied = 1e300;
  for (std::size_t s = 0; s < forms.size(); ++s) {
    const double w = forms.weight(s, f);
    sum += w;
    greatest = std::max(greatest, w);
    if ((tied >> s & 1) != 0) least_tied = std::min(least_tied, w);
  }
  return greatest - least_tied <= kTolerance * sum;
}

}  // namespace

std::optional<Point> tie_point(const WeightForms& forms, SlotMask tied, const Point& start, const Box& box,
                               double reach) {
  const Differences differences(forms, tied);
  Point f = start;
  for (int i = 0; i < kMostSteps; ++i) {
    Vector d = differences.step(f);
    const double length = std::sqrt(squared_length(d));
    if (!(length < 1e6)) return std::nullopt;
    if (length > kLongestStep) d = (kLongestStep / length) * d;
    f = f + d;
    if (distance(f, start) > reach) return std::nullopt;
    if (length < kConverged) break;
  }
  const Point in{std::clamp(f.x, box.low.x, box.high.x), std::clamp(f.y, box.low.y, box.high.y),
                 std::clamp(f.z, box.low.z, box.high.z)};
  if (distance(f, in) > kTolerance || !is_tie(forms, tied, in)) return std::nullopt;
  return in;
}

}  // namespace podm
