#include "phantoms/phantom_head.h"

#include <algorithm>
#include <cmath>

namespace podm {

namespace {

constexpr double kScalpMm = 6, kSkullMm = 7, kFluidMm = 2.5, kGreyMm = 5;
constexpr double kSulcusMm = 10, kSulcusPeriod = 10;     // depth; period over 2 pi, mm
constexpr double kSulcusWidth = 0.35, kGreyWidth = 1.1;  // in units of the function of the folds

Shape layer(double depth_mm) {
  return ellipsoid({0, 0, 0}, kHeadHalfExtent - Vector{depth_mm, depth_mm, depth_mm});
}

// A smooth function of period 2 pi along each axis. Its zeros are a surface that cuts the brain's into gyri.
double folds(const Point& p) {
  const Point q = (1 / kSulcusPeriod) * p;
  return std::sin(q.x) * std::cos(q.y) + std::sin(q.y) * std::cos(q.z) + std::sin(q.z) * std::cos(q.x);
}

// The ellipsoid at a depth, with valleys around the zeros of the folds.
Shape folded(double depth_mm, double valley_mm, double valley_width) {
  Shape shape = layer(depth_mm);
  const Vector radii = shape.high;
  shape.value = [=](const Point& p) {
    const double r = std::sqrt(squared_length({p.x / radii.x, p.y / radii.y, p.z / radii.z}));
    const double at = folds(p) / valley_width;
    return r - 1 + valley_mm / radii.x * std::exp(-at * at * at * at);
  };
  return shape;
}

}  // namespace

std::vector<Organ> head_organs() {
  constexpr double kBrain = kScalpMm + kSkullMm + kFluidMm;
  std::vector<Organ> organs{{1, "scalp", layer(0)},
                            {2, "skull", layer(kScalpMm)},
                            {3, "csf", layer(kScalpMm + kSkullMm)},
                            {4, "grey matter", folded(kBrain, kSulcusMm, kSulcusWidth)},
                            {5, "white matter", folded(kBrain + kGreyMm, kSulcusMm, kGreyWidth)}};
  const Shape ventricle = leaning(ellipsoid({14, 0, 8}, {6, 30, 12}), {14, 0, 8}, 20);
  organs.push_back({6, "ventricles", ventricle});
  organs.push_back({6, "ventricles", mirrored(ventricle)});
  return organs;
}

}  // namespace podm
