#include "image/isosurface.h"

#include <algorithm>
#include <limits>

#include "image/working_frame.h"

namespace podm {

namespace {

double square(double x) { return x * x; }

// The number of [low, high] that is nearest to x; low if x is not a number.
double clamped(double x, double low, double high) { return std::max(low, std::min(x, high)); }

// The 26 neighbours of a block reach at most so many of its sides beyond any of its points, in the worst
// direction.
constexpr double kMostByBlocks = 1.5;

// The 64 corners of a block and of its 26 neighbours, a bit each: corner (i,j,k) of {0..3}^3 at i + 4 j + 16
// k.
constexpr std::uint64_t kFirstCorners = 0x0777'0777'0777;  // {0..2}^3, by which the 27 blocks are numbered

}  // namespace

template <class Reads>
Oracle<Reads>::Oracle(const LabelImage& image, std::shared_ptr<const FeatureTransform> transform,
                      const Reads& reads)
    : image_(&image),
      transform_(std::move(transform)),
      grid_(image, reads),
      features_(transform_->words().data(), reads),
      from_voxels_(voxels_to_working(image)),
      to_voxels_(inverse(from_voxels_)),
      spacing_{image.spacing[0], image.spacing[1], image.spacing[2]},
      inverse_spacing_{1 / spacing_.x, 1 / spacing_.y, 1 / spacing_.z},
      end_{image.size[0] - 0.5, image.size[1] - 0.5, image.size[2] - 0.5},
      half_diagonal_mm_(0.5 * std::sqrt(squared_length(spacing_))),
      shortest_side_mm_(std::min({spacing_.x, spacing_.y, spacing_.z})),
      longest_side_mm_(std::max({spacing_.x, spacing_.y, spacing_.z})),
      weight_mm_(1 / std::sqrt(squared_length(inverse_spacing_))) {}

template <class Reads>
LabelIndex Oracle<Reads>::label_on_surface_voxel(const Point& u) const {
  const Voxel block = block_of(u);
  return winner(grid_.block(block), u - center(block)).label;
}

template <class Reads>
Point Oracle<Reads>::clamped_to_grid(const Point& u) const {
  return {clamped(u.x, 0, end_.x - 0.5), clamped(u.y, 0, end_.y - 0.5), clamped(u.z, 0, end_.z - 0.5)};
}

template <class Reads>
double Oracle<Reads>::distance_lower_bound(const Point& p, double radius) const {
  const Point u = to_voxels(p);
  const double bound = clearance(u);
  const bool may_blocks_tell = bound <= radius && radius < kMostByBlocks * shortest_side_mm_ && is_inside(u);
  return may_blocks_tell ? std::max(bound, bound_by_blocks(u)) : std::max(bound, 0.0);
}

// The isosurface lies within half a voxel of the grid. p projects to p' on that convex box, and
// |p - s|^2 >= |p - p'|^2 + |p' - s|^2 for any s in it.
template <class Reads>
double Oracle<Reads>::bound_from_outside(const Point& u) const {
  const Point inside{clamped(u.x, -0.5, end_.x), clamped(u.y, -0.5, end_.y), clamped(u.z, -0.5, end_.z)};
  const double bound = std::max(0.0, bound_by_feature(inside, nearest_voxel(clamped_to_grid(inside))));
  return std::sqrt(squared_length(to_mm(u - inside)) + square(bound));
}

// The lemma says that every isosurface point is within half a voxel diagonal of a surface voxel, and no
// surface voxel is nearer to v than its feature. May be negative.
template <class Reads>
double Oracle<Reads>::bound_by_feature(const Point& u, const Voxel& v) const {
  const auto feature = features_.nearest(grid_.index(v));
  if (feature == Features<Reads>::kNone) return std::numeric_limits<double>::infinity();
  return length_mm(center(v) - center(grid_.voxel(feature))) - length_mm(u - center(v)) - half_diagonal_mm_;
}

// No isosurface passes a block of one label: the nearest of the 26 neighbours that has another bounds the
// distance, or else their outer hull does. Where u's own block has several, the winner's weight tells: it has
// to fall to 1/2, and changes by at most 1 a voxel along each axis.
template <class Reads>
double Oracle<Reads>::bound_by_blocks(const Point& u) const {
  const Voxel block = block_of(u);
  const Point f = u - center(block);
  const BlockLabels labels = grid_.block(block);
  const LabelIndex label = labels.corner[0];
  if (!labels.is_uniform(label)) return std::max(0.0, winner(labels, f).weight - 0.5) * weight_mm_;

  std::uint64_t others = grid_.corners_of_other_label(block, label);
  others |= others >> 1;
  others |= others >> 4;
  others |= others >> 16;
  const Vector below = to_mm(f), above = to_mm(Vector{1, 1, 1} - f);
  const std::array<double, 4> x2 = {square(below.x), 0, square(above.x), 0},
                              y2 = {square(below.y), 0, square(above.y), 0},
                              z2 = {square(below.z), 0, square(above.z), 0};
  double squared =
      square(std::min({spacing_.x + std::min(below.x, above.x), spacing_.y + std::min(below.y, above.y),
                       spacing_.z + std::min(below.z, above.z)}));
  for (others &= kFirstCorners; others != 0; others &= others - 1) {
    const auto b = static_cast<std::size_t>(std::countr_zero(others));
    squared = std::min(squared, x2[b & 3] + y2[b >> 2 & 3] + z2[b >> 4]);
  }
  return std::sqrt(squared);
}

// Members are spread over files, each of which makes its own for both oracles.
template Oracle<NoReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>, const NoReads&);
template Oracle<CountedReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>,
                                      const CountedReads&);
template LabelIndex Oracle<NoReads>::label_on_surface_voxel(const Point&) const;
template LabelIndex Oracle<CountedReads>::label_on_surface_voxel(const Point&) const;
template Point Oracle<NoReads>::clamped_to_grid(const Point&) const;
template Point Oracle<CountedReads>::clamped_to_grid(const Point&) const;
template double Oracle<NoReads>::distance_lower_bound(const Point&, double) const;
template double Oracle<CountedReads>::distance_lower_bound(const Point&, double) const;
template double Oracle<NoReads>::bound_from_outside(const Point&) const;
template double Oracle<CountedReads>::bound_from_outside(const Point&) const;
template double Oracle<NoReads>::bound_by_feature(const Point&, const Voxel&) const;
template double Oracle<CountedReads>::bound_by_feature(const Point&, const Voxel&) const;

}  // namespace podm
