#include "image/isosurface.h"

#include <algorithm>
#include <limits>

namespace podm {

Isosurface::Isosurface(const LabelImage& image, int threads)
    : grid_(image),
      features_(image, threads),
      spacing_{image.spacing[0], image.spacing[1], image.spacing[2]},
      inverse_spacing_{1 / spacing_.x, 1 / spacing_.y, 1 / spacing_.z},
      half_diagonal_mm_(0.5 * std::sqrt(squared_length(spacing_))) {}

LabelIndex Isosurface::label_at(const Point& p) const { return label_at_voxels(to_voxels(p)); }

LabelIndex Isosurface::label_at_voxels(const Point& u) const {
  // Half a voxel outside the grid background has at least half the weight.
  const auto is_in = [](double x, int n) { return x > -0.5 && x < n - 0.5; };
  if (!is_in(u.x, grid_.num_x()) || !is_in(u.y, grid_.num_y()) || !is_in(u.z, grid_.num_z())) {
    return kBackground;
  }
  const Voxel v = nearest_voxel(u);
  const std::size_t index = grid_.index(v);
  // By the lemma only a tie at the block's centre can take the label from a voxel off the surface.
  constexpr double kNotCenter = 1.5 - 1e-9;
  const Vector offset = u - center(v);
  if (features_.nearest(index) != index &&
      std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z) < kNotCenter) {
    return grid_.label(index);
  }
  const Voxel block = block_of(u);
  return winner(grid_.block(block), u - center(block));
}

Voxel Isosurface::nearest_voxel(const Point& u) const {
  const auto nearest = [](double x, int n) {
    return static_cast<int>(std::clamp(std::floor(x + 0.5), 0.0, static_cast<double>(n - 1)));
  };
  return {nearest(u.x, grid_.num_x()), nearest(u.y, grid_.num_y()), nearest(u.z, grid_.num_z())};
}

// By the lemma every isosurface point is within half a voxel diagonal of a surface voxel, and no surface
// voxel is nearer to the voxel around p than its feature. The isosurface lies within half a voxel of the
// grid: for p outside of that convex box, which p projects to p', |p - s|^2 >= |p - p'|^2 + |p' - s|^2.
double Isosurface::feature_bound_mm(const Point& u) const {
  const Voxel v = nearest_voxel(u);
  const auto feature = features_.nearest(grid_.index(v));
  if (feature == FeatureTransform::kNone) return std::numeric_limits<double>::infinity();
  const Point inside{std::clamp(u.x, -0.5, grid_.num_x() - 0.5), std::clamp(u.y, -0.5, grid_.num_y() - 0.5),
                     std::clamp(u.z, -0.5, grid_.num_z() - 0.5)};
  const double bound =
      length_mm(center(v) - center(grid_.voxel(feature))) - length_mm(inside - center(v)) - half_diagonal_mm_;
  const double outside2 = squared_length(to_mm(u - inside));
  if (outside2 == 0) return std::max(bound, 0.0);
  return std::sqrt(outside2 + std::max(bound, 0.0) * std::max(bound, 0.0));
}

double Isosurface::distance_lower_bound(const Point& p) const { return feature_bound_mm(to_voxels(p)); }

}  // namespace podm
