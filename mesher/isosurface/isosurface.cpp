#include "isosurface/isosurface.h"

#include <algorithm>

#include "image/working_frame.h"

namespace podm {

namespace {

double square(double x) { return x * x; }

// Exceeds 1 by more than the rounding errors.
constexpr double kAboveRounding = 1 + 1e-9;

}  // namespace

template <class Reads>
Oracle<Reads>::Oracle(const LabelImage& image, std::shared_ptr<const FeatureTransform> transform,
                      std::shared_ptr<const VoxelWeights> weights, const Reads& reads)
    : image_(&image),
      transform_(std::move(transform)),
      weights_(std::move(weights)),
      grid_(image, reads, transform_.get()),
      features_(*transform_, reads),
      box_(image.is_box_flat ? std::optional(BoxPlanes(image)) : std::nullopt),
      from_voxels_(voxels_to_working(image)),
      to_voxels_(inverse(from_voxels_)),
      spacing_{image.spacing[0], image.spacing[1], image.spacing[2]},
      inverse_spacing_{1 / spacing_.x, 1 / spacing_.y, 1 / spacing_.z},
      end_{image.size[0] - 0.5, image.size[1] - 0.5, image.size[2] - 0.5},
      half_diagonal_mm_(0.5 * std::sqrt(squared_length(spacing_))),
      shortest_side_mm_(std::min({spacing_.x, spacing_.y, spacing_.z})),
      to_surface_voxel_mm_(weights_ != nullptr ? 2 * half_diagonal_mm_ : half_diagonal_mm_),
      beyond_bricks_mm_(to_surface_voxel_mm_ - half_diagonal_mm_) {}

// The neighborhood of v gives the corners of u's block that differ from v. If there are two labels, their
// weights decide. A label of the block then has to be read only if the other label wins.
template <class Reads>
LabelIndex Oracle<Reads>::label_by_neighborhood(const Point& u, const Voxel& v,
                                                const StoredFeature& of_v) const {
  const LabelIndex own = of_v.label();
  const Neighborhood around = features_.neighborhood(of_v.brick(), v);
  const Voxel block = block_of(u);
  const CornerMask others = around.differing_corners(block.i - v.i, block.j - v.j, block.k - v.k);
  if (own == StoredFeature::kLabelTooLarge || (others != 0 && !around.has_two_labels()))
    return label_by_block(u);
  if (others == 0) return own;
  const Point f = u - center(block);
  const auto [of_own, of_other] = with_weights(block, [&](const auto& weights) {
    return std::pair(weight(~others & kAllCorners, f, weights), weight(others, f, weights));
  });
  if (of_own > of_other) return own;
  const auto c = std::countr_zero(others);
  const LabelIndex other = grid_.label({block.i + (c & 1), block.j + (c >> 1 & 1), block.k + (c >> 2)});
  return of_own == of_other ? std::min(own, other) : other;
}

template <class Reads>
LabelIndex Oracle<Reads>::label_by_block(const Point& u) const {
  const Voxel block = block_of(u);
  return with_weights(block, [&](const auto& weights) {
    return winner(grid_.block(block), u - center(block), weights).label;
  });
}

// The block of u may still have several labels, but only if a voxel next to v is a surface voxel. The feature
// of v may be another voxel where voxels are long, but it is then at most one diagonal away.
template <class Reads>
LabelIndex Oracle<Reads>::label_off_surface(const Point& u, const Voxel& v, const StoredFeature& of_v) const {
  const std::optional<Voxel> offset = of_v.offset();
  const double diagonal_mm = 2 * half_diagonal_mm_ * kAboveRounding;
  if (offset && length_mm(center(*offset)) <= diagonal_mm) return label_by_block(u);
  return of_v.brick().label() == Brick::kMixed ? grid_.label_inside(v) : of_v.brick().label();
}

template <class Reads>
LabelAndBound Oracle<Reads>::label_and_bound_of_image(const Point& p, double radius) const {
  const Point u = to_voxels(p);
  if (!is_inside(u)) return {kBackground, std::max(bound_from_outside(u, radius), 0.0)};
  const Voxel v = nearest_voxel(u);
  const StoredFeature of_v = features_.stored(features_.brick_of(v), v);
  return {label_by_feature(u, v, of_v), std::max(bound_by_feature(u, v, of_v, radius), 0.0)};
}

template <class Reads>
double Oracle<Reads>::bound_of_image(const Point& p, double radius) const {
  return std::max(clearance(to_voxels(p), radius), 0.0);
}

// The isosurface lies in the convex box of the grid grown by half a voxel. Let p' be the projection of p on
// that box. Then |p - s|^2 >= |p - p'|^2 + |p' - s|^2 for any s in the box.
template <class Reads>
double Oracle<Reads>::bound_from_outside(const Point& u, double radius) const {
  const Point inside{clamped(u.x, -0.5, end_.x), clamped(u.y, -0.5, end_.y), clamped(u.z, -0.5, end_.z)};
  const double bound = std::max(0.0, bound_by_voxel(inside, nearest_voxel(clamped_to_grid(inside)), radius));
  return std::sqrt(squared_length(to_mm(u - inside)) + square(bound));
}

// The lemma states that every isosurface point is within half a voxel of a surface voxel. It therefore lies
// in a brick that has surface voxels, and within half a diagonal of a surface voxel's center. No surface
// voxel's center is nearer to that of v than that of v's feature. Where interfaces are smoothed, the two
// bounds grow by half a voxel and by half a diagonal.
template <class Reads>
double Oracle<Reads>::bound_by_feature(const Point& u, const Voxel& v, const StoredFeature& of_v,
                                       double radius) const {
  const Brick brick = of_v.brick();
  const std::optional<Voxel> offset = of_v.offset();
  const double from_center = length_mm(u - center(v)) + to_surface_voxel_mm_;
  if (offset) return length_mm(center(*offset)) - from_center;
  const double bound = brick.is_near() ? features_.reach_mm() - from_center
                                       : features_.distance_from_far(brick) - beyond_bricks_mm_;
  if (bound > radius || is_empty()) return bound;
  const double reach = (radius + to_surface_voxel_mm_) * kAboveRounding;
  return features_.is_surface_within(u, reach) ? bound : reach - to_surface_voxel_mm_;
}

// Each file that defines members instantiates its own for both oracles.
template Oracle<NoReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>,
                                 std::shared_ptr<const VoxelWeights>, const NoReads&);
template Oracle<CountedReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>,
                                      std::shared_ptr<const VoxelWeights>, const CountedReads&);
template LabelIndex Oracle<NoReads>::label_by_neighborhood(const Point&, const Voxel&,
                                                           const StoredFeature&) const;
template LabelIndex Oracle<CountedReads>::label_by_neighborhood(const Point&, const Voxel&,
                                                                const StoredFeature&) const;
template LabelIndex Oracle<NoReads>::label_by_block(const Point&) const;
template LabelIndex Oracle<CountedReads>::label_by_block(const Point&) const;
template LabelIndex Oracle<NoReads>::label_off_surface(const Point&, const Voxel&,
                                                       const StoredFeature&) const;
template LabelAndBound Oracle<NoReads>::label_and_bound_of_image(const Point&, double) const;
template LabelIndex Oracle<CountedReads>::label_off_surface(const Point&, const Voxel&,
                                                            const StoredFeature&) const;
template LabelAndBound Oracle<CountedReads>::label_and_bound_of_image(const Point&, double) const;
template double Oracle<NoReads>::bound_of_image(const Point&, double) const;
template double Oracle<CountedReads>::bound_of_image(const Point&, double) const;
template double Oracle<NoReads>::bound_from_outside(const Point&, double) const;
template double Oracle<CountedReads>::bound_from_outside(const Point&, double) const;
template double Oracle<NoReads>::bound_by_feature(const Point&, const Voxel&, const StoredFeature&,
                                                  double) const;
template double Oracle<CountedReads>::bound_by_feature(const Point&, const Voxel&, const StoredFeature&,
                                                       double) const;

}  // namespace podm
