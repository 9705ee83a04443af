// The isosurface point nearest to a point: shots at the nearest surface voxels, each improved by shooting
// along the normal at the point it hit.
#include <algorithm>
#include <limits>

#include "image/isosurface.h"

namespace podm {

struct Isosurface::Nearest {
  Point u;
  double squared_mm = std::numeric_limits<double>::infinity();
};

namespace {

constexpr int kMaxShots = 6;
constexpr double kGoodEnough = 1 - 1e-4;  // of the distance: improved by less, the search ends

}  // namespace

// Nearest to u among the feature and its neighbours; one of them has another label.
std::optional<Voxel> Isosurface::nearest_other_label(const Point& u, FeatureTransform::VoxelIndex feature,
                                                     LabelIndex label) const {
  const Voxel v = grid_.voxel(feature);
  if (grid_.label(feature) != label) return v;
  std::optional<Voxel> nearest;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const Voxel& n : {Voxel{v.i - 1, v.j, v.k}, Voxel{v.i + 1, v.j, v.k}, Voxel{v.i, v.j - 1, v.k},
                         Voxel{v.i, v.j + 1, v.k}, Voxel{v.i, v.j, v.k - 1}, Voxel{v.i, v.j, v.k + 1}}) {
    const double squared = squared_length(to_mm(center(n) - u));
    if (squared >= nearest2 || grid_.label(n) == label) continue;
    nearest2 = squared;
    nearest = n;
  }
  return nearest;
}

// Of the weight of a less that of b, per mm.
Vector Isosurface::normal_mm(const Point& u, const Voxel& block, LabelIndex a, LabelIndex b) const {
  const Vector g = gradient(weight_difference(grid_.block(block), a, b), u - center(block));
  return {g.x * inverse_spacing_.x, g.y * inverse_spacing_.y, g.z * inverse_spacing_.z};
}

void Isosurface::improve(const Point& u, LabelIndex label, const Voxel& target, Nearest& best) const {
  Nearest here;
  Vector d = center(target) - u;
  for (int shot = 0; shot < kMaxShots; ++shot) {
    const auto change = first_change(u, d, label);
    if (!change) break;
    const Point z = u + change->t * d;
    const double squared = squared_length(to_mm(z - u));
    const bool is_settled = squared >= here.squared_mm * kGoodEnough;
    if (squared < here.squared_mm) here = {z, squared};
    if (is_settled || squared == 0) break;
    const Vector normal = normal_mm(z, change->block, label, change->to);
    const double length2 = squared_length(normal);
    if (length2 == 0) break;
    // As far as the best so far, against the normal.
    d = to_voxels((-std::sqrt(here.squared_mm / length2)) * normal);
  }
  if (here.squared_mm < best.squared_mm) best = here;
}

std::optional<Point> Isosurface::closest_point(const Point& p, double radius) const {
  const Point u = to_voxels(p);
  const LabelIndex label = label_at_voxels(u);
  Nearest best;
  const Voxel block = block_of(u);
  std::array<FeatureTransform::VoxelIndex, 8> tried;
  std::size_t num_tried = 0;
  for (int c = 0; c < 8; ++c) {
    const Point corner = center({block.i + (c & 1), block.j + (c >> 1 & 1), block.k + (c >> 2)});
    const auto feature = features_.nearest(grid_.index(nearest_voxel(corner)));
    if (feature == FeatureTransform::kNone) return std::nullopt;
    if (std::find(tried.begin(), tried.begin() + num_tried, feature) != tried.begin() + num_tried) continue;
    tried[num_tried++] = feature;
    if (const auto target = nearest_other_label(u, feature, label)) improve(u, label, *target, best);
  }
  if (!(best.squared_mm <= radius * radius)) return std::nullopt;
  return to_mm(best.u);
}

}  // namespace podm
