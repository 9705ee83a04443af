#include "image/isosurface.h"

#include <algorithm>
#include <limits>

#include "image/working_frame.h"

namespace podm {

namespace {

double square(double x) { return x * x; }

// The number of [low, high] that is nearest to x; low if x is not a number.
double clamped(double x, double low, double high) { return std::max(low, std::min(x, high)); }

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
      shortest_side_mm_(std::min({spacing_.x, spacing_.y, spacing_.z})) {}

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
double Oracle<Reads>::distance_lower_bound(const Point& p) const {
  return std::max(clearance(to_voxels(p)), 0.0);
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

// Members are spread over files, each of which makes its own for both oracles.
template Oracle<NoReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>, const NoReads&);
template Oracle<CountedReads>::Oracle(const LabelImage&, std::shared_ptr<const FeatureTransform>,
                                      const CountedReads&);
template LabelIndex Oracle<NoReads>::label_on_surface_voxel(const Point&) const;
template LabelIndex Oracle<CountedReads>::label_on_surface_voxel(const Point&) const;
template Point Oracle<NoReads>::clamped_to_grid(const Point&) const;
template Point Oracle<CountedReads>::clamped_to_grid(const Point&) const;
template double Oracle<NoReads>::distance_lower_bound(const Point&) const;
template double Oracle<CountedReads>::distance_lower_bound(const Point&) const;
template double Oracle<NoReads>::bound_from_outside(const Point&) const;
template double Oracle<CountedReads>::bound_from_outside(const Point&) const;
template double Oracle<NoReads>::bound_by_feature(const Point&, const Voxel&) const;
template double Oracle<CountedReads>::bound_by_feature(const Point&, const Voxel&) const;

}  // namespace podm
